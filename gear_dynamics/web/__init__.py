"""The live page in the browser; fed by results, knows no ROS."""
