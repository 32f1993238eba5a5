"""What becomes of eyes with a disorder: runs examined at several ages, one page of them."""
