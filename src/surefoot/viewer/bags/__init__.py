"""Recordings for other tools: MCAP files of ROS 2 messages."""
