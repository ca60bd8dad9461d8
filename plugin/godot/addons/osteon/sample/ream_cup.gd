extends Spatial
# Reams the shipped acetabulum: the hand feeds 2 mm/s along the cup's axis, from 17 mm below the cup's centre.

const FEED_M_PER_S := 0.002
const START_M := -0.017

var _time_s := 0.0

onready var _bone: Spatial = $Bone
onready var _tool: Spatial = $Tool

func _process(delta: float) -> void:
	if _bone.session == null:
		return
	_time_s += delta
	_tool.global_transform = _bone.global_transform * _bone.approach(START_M - FEED_M_PER_S * _time_s)
