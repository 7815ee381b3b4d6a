"""The rigid motion of a cloud that lies anywhere into the machine's axes."""
