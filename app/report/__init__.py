"""What is handed on of a decision: a report to read, and files for other programs."""
