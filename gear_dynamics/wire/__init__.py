"""Message bytes and PointCloud2 tables."""
