"""What becomes of eyes that differ from healthy ones: one page of conditions."""
