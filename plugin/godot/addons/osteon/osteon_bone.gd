extends Spatial
# A bone that a tool cuts. Its mesh follows the cut: one MeshInstance a brick of the surface.
# Axes: Godot's, in metres, in this node's own frame; the bone's site opens along +y in the shipped scenes.

# A bone, a tool or a call was refused; the text says what was found and what is accepted.
signal failed(text)
# Something that the scene watches: "breakthrough", "wall too thin", …
signal scene_event(name, value_m, position)
# A brick's mesh has changed: arrays as ArrayMesh.add_surface_from_arrays takes them, empty where the brick has gone.
signal brick_changed(number, arrays)

# A shipped scene: acetabulum, molar, femoral_canal, …
export(String) var scene_name := "acetabulum"
# The OsteonTool that cuts
export(NodePath) var tool_path := NodePath("../Tool")
# Largest force of the hand [N]: above 0, at most 200
export(float) var max_force_N := 200.0
# Folder of scenes/, tools/ and materials/; empty: the add-on's own
export(String) var config_folder := ""
export(String, "auto", "cpu", "vulkan") var engine := "auto"
# What gives way, as OsteonSession.set_compliance takes it: {"mount": true, "mount_mass_kg": 12.0}; empty: nothing
export(Dictionary) var compliance := {}
# Without one: the vertices' own colours, one for each tissue
export(Material) var material: Material

# The OsteonSession, for a haptic device's own thread (set_tool_pose and force never wait); null where none is open.
var session: Reference = null

var _tool: Spatial
var _bricks := {}     # by number: MeshInstance
var _triangles := {}  # by number
var _last_failure := ""

func _enter_tree() -> void:
	_last_failure = ""
	_tool = get_node_or_null(tool_path) as Spatial
	if _tool == null or not "tool_name" in _tool:
		_fail("tool_path: found '%s', accepted the path of an OsteonTool" % tool_path)
		return
	var opened = preload("res://addons/osteon/osteon_session.gdns").new()
	var wrong: String = opened.open({
		"scene": scene_name, "tool": _tool.tool_name, "diameter_m": _tool.diameter_m,
		"max_force_N": max_force_N, "config_folder": config_folder, "engine": engine})
	if wrong.empty() and not compliance.empty():
		wrong = opened.set_compliance(compliance)
	if wrong.empty():
		session = opened
	else:
		_fail(wrong)

func _exit_tree() -> void:
	if session != null:
		session.close()
	session = null
	for brick in _bricks.values():
		brick.queue_free()
	_bricks.clear()
	_triangles.clear()

func _process(_delta: float) -> void:
	if session == null or not is_instance_valid(_tool):
		return
	var wrong: String = session.set_tool_pose(tool_pose(), _tool.spins)
	if not wrong.empty():
		_fail(wrong)
	for change in session.surface_changes():
		_show_brick(change[0], change[1])
	if not compliance.empty():
		# the bone is drawn where its mount has let it go by the newest force()
		var place: Transform = session.deflection().bone
		for brick in _bricks.values():
			brick.transform = place
	var event = session.next_event()
	while event != null:
		emit_signal("scene_event", event.name, event.value_m, event.position)
		event = session.next_event()

# Pose of the tool in the bone's frame.
func tool_pose() -> Transform:
	return global_transform.affine_inverse() * _tool.global_transform

# Pose of a tool that points into the site, its apex height_m above the site's centre, in the bone's frame.
func approach(height_m: float) -> Transform:
	return session.approach(height_m)

# The force [N] that the hand should feel now, in the bone's frame; velocity of the tool's apex [m/s] and angular
# velocity [rad/s] in that frame, as a device measures them: zero for a tool at rest.
func force(linear := Vector3.ZERO, angular := Vector3.ZERO) -> Vector3:
	return session.force(tool_pose(), linear, angular)[0] if session != null else Vector3.ZERO

func triangle_count() -> int:
	var count := 0
	for triangles in _triangles.values():
		count += triangles
	return count

func _show_brick(number: int, arrays: Array) -> void:
	if not _bricks.has(number):
		var part := MeshInstance.new()
		part.name = "brick_%d" % number
		part.mesh = ArrayMesh.new()
		part.material_override = material if material != null else _vertex_colours()
		add_child(part)
		_bricks[number] = part
	var mesh: ArrayMesh = _bricks[number].mesh
	while mesh.get_surface_count() > 0:
		mesh.surface_remove(0)
	if not arrays.empty():
		mesh.add_surface_from_arrays(Mesh.PRIMITIVE_TRIANGLES, arrays)
	_triangles[number] = 0 if arrays.empty() else arrays[Mesh.ARRAY_INDEX].size() / 3
	emit_signal("brick_changed", number, arrays)

func _vertex_colours() -> Material:
	var colours := SpatialMaterial.new()
	colours.vertex_color_use_as_albedo = true
	colours.vertex_color_is_srgb = true
	material = colours
	return colours

# Says each failure once, not in every frame.
func _fail(text: String) -> void:
	if text == _last_failure:
		return
	_last_failure = text
	push_warning("osteon: " + text)
	emit_signal("failed", text)
