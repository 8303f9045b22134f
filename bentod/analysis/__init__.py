"""What is made of a recording: tables, task metrics, figures and a report."""
