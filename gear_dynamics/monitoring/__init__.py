"""Online analysis of a stream: tasks, results, alarms."""
