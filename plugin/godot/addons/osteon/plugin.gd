tool
extends EditorPlugin
# Adds the nodes OsteonBone and OsteonTool to the editor's list.

func _enter_tree():
	add_custom_type("OsteonBone", "Spatial", preload("res://addons/osteon/osteon_bone.gd"), null)
	add_custom_type("OsteonTool", "Spatial", preload("res://addons/osteon/osteon_tool.gd"), null)

func _exit_tree():
	remove_custom_type("OsteonTool")
	remove_custom_type("OsteonBone")
