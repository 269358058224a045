"""What the odometry machine is made of: error laws, distance-measuring devices, marker readings, one cycle."""
