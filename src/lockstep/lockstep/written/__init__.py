"""What people write: command lines, names, paths and YAML."""
