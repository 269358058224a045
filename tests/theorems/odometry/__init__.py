"""The odometry machine on a line of markers, and beside itself with its front reader alone; and what is claimed of both."""
