"""The paper's experiment again, from rendered pictures: docs/table2.md."""
