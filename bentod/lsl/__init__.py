"""The arm as streams of the lab streaming layer, for those who record with LabRecorder."""
