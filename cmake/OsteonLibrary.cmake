# osteon_library(NAME SOURCES a.cpp … HEADERS a.h … [PRIVATE_HEADERS b.h …] [LINK osteon::x …] [PRIVATE yaml-cpp …])
# Adds a folder's static library, with the alias osteon::NAME. HEADERS are included by other folders; they form a header
# set, so that the target <name>_verify_interface_header_sets (all of them: all_verify_interface_header_sets) compiles
# each alone, with LINK only. PRIVATE_HEADERS are internal, may use the libraries of PRIVATE, and are compiled alone by
# the target osteon_verify_private_headers.
#
# Sources between two "|" are compiled as one file (osteon_together): names in their unnamed namespaces must differ.
set(CMAKE_VERIFY_INTERFACE_HEADER_SETS ON)
add_custom_target(osteon_verify_private_headers)

# osteon_together(TARGET a.cpp b.cpp | c.cpp …): adds sources; each group between "|" is compiled as one file if
# OSTEON_TOGETHER is ON. Most of a file's compile time goes into its headers' templates, compiled once per group.
function(osteon_together TARGET)
  set(group 0)
  foreach(source ${ARGN})
    if(source STREQUAL "|")
      math(EXPR group "${group} + 1")
    else()
      target_sources(${TARGET} PRIVATE ${source})
      set_source_files_properties(${source} PROPERTIES UNITY_GROUP ${TARGET}_${group})
    endif()
  endforeach()
  set_target_properties(${TARGET} PROPERTIES UNITY_BUILD "${OSTEON_TOGETHER}" UNITY_BUILD_MODE GROUP)
endfunction()

function(osteon_library NAME)
  cmake_parse_arguments(ARG "" "" "SOURCES;HEADERS;PRIVATE_HEADERS;LINK;PRIVATE" ${ARGN})
  if(ARG_SOURCES)
    add_library(osteon_${NAME} STATIC)
    osteon_together(osteon_${NAME} ${ARG_SOURCES})
    target_link_libraries(osteon_${NAME} PUBLIC osteon::options ${ARG_LINK} PRIVATE ${ARG_PRIVATE})
    set(scope PUBLIC)
  else()
    add_library(osteon_${NAME} INTERFACE)
    target_link_libraries(osteon_${NAME} INTERFACE osteon::options ${ARG_LINK})
    set(scope INTERFACE)
  endif()
  add_library(osteon::${NAME} ALIAS osteon_${NAME})
  target_sources(osteon_${NAME} ${scope} FILE_SET HEADERS BASE_DIRS ${PROJECT_SOURCE_DIR} FILES ${ARG_HEADERS})

  if(ARG_PRIVATE_HEADERS)
    set(target osteon_${NAME}_verify_private_headers)
    set(sources)
    foreach(header ${ARG_PRIVATE_HEADERS})
      cmake_path(RELATIVE_PATH CMAKE_CURRENT_SOURCE_DIR BASE_DIRECTORY ${PROJECT_SOURCE_DIR} OUTPUT_VARIABLE folder)
      set(source ${CMAKE_CURRENT_BINARY_DIR}/${target}/${folder}/${header}.cxx)
      file(CONFIGURE OUTPUT ${source} CONTENT "#include \"${folder}/${header}\"\n" @ONLY)
      list(APPEND sources ${source})
    endforeach()
    add_library(${target} OBJECT EXCLUDE_FROM_ALL ${sources})
    target_link_libraries(${target} PRIVATE osteon_${NAME} ${ARG_PRIVATE})
    add_dependencies(osteon_verify_private_headers ${target})
  endif()
endfunction()
