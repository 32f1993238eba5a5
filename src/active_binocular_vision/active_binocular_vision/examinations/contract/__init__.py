"""What an examination is: options, rows of declared measures, a document."""
