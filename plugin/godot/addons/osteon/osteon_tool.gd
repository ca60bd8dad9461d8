extends Spatial
# A tool: its origin is the apex. Osteon's +z, the feed, is +y here.

# A shipped tool: reamer, twist_drill, round_burr, …
export(String) var tool_name := "reamer"
# Diameter [m]; 0: the tool's usual one
export(float) var diameter_m := 0.0
# Whether the spindle turns
export(bool) var spins := true
