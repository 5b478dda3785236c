"""A judge for each method: which results of each stage a correct port may have."""
