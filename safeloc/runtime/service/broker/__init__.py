"""Many vehicles over an MQTT broker, divided among several processes. See docs/fleet.md."""
