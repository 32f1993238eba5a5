"""Episodes, tests, bags and measures of an experiment."""
