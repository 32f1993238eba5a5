"""Episodes, tests, bags, measures and figures of an experiment."""
