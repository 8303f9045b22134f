"""Recordings played again: to clients as if they were live, and to learners as if they had to learn again."""
