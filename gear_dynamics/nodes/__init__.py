"""Thin rclpy shells: parameters, topics, timers. The only place that knows rclpy."""
