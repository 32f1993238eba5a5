"""Pages for a browser: a report, and tables of conditions."""
