# cmake --install BUILD [--prefix P] [--component C], and Debian packages by cpack (docs/engine.md).
#
#     component   Debian package   what
#     osteon      osteon           the command, its studies, config/, the console's page, manual page, completions,
#                                  systemd unit with its user and group, real-time rights
#     library     libosteon0       libosteon.so.0
#     development libosteon-dev    osteon.h, osteon_host*.h, CMake package, pkg-config file, Python module, examples
#     godot       (none)           the add-on as it lies in a project: plugin/godot/CMakeLists.txt
include(GNUInstallDirs)
include(CMakePackageConfigHelpers)

set(packaging ${PROJECT_SOURCE_DIR}/plugin/packaging)

# --- the command
install(TARGETS osteon_app osteon_studies RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR} COMPONENT osteon)
install(DIRECTORY config/ DESTINATION ${CMAKE_INSTALL_DATADIR}/osteon/config COMPONENT osteon
  PATTERN "reading" EXCLUDE PATTERN "CMakeLists.txt" EXCLUDE)
install(DIRECTORY ${PROJECT_BINARY_DIR}/console/web/ DESTINATION ${CMAKE_INSTALL_DATADIR}/osteon/console COMPONENT osteon
  OPTIONAL)
# manual page and completions are written by the command itself, from the options that it parses
install(CODE "
  set(command \"$<TARGET_FILE:osteon_app>\")
  set(share \"\$ENV{DESTDIR}\${CMAKE_INSTALL_PREFIX}/${CMAKE_INSTALL_DATADIR}\")
  set(completions \"\${share}/bash-completion/completions/osteon\" \"\${share}/zsh/vendor-completions/_osteon\"
    \"\${share}/fish/vendor_completions.d/osteon.fish\")
  set(shells bash zsh fish)
  file(MAKE_DIRECTORY \"\${share}/man/man1\")
  execute_process(COMMAND \${command} manual --man \"\${share}/man/man1/osteon.1\" COMMAND_ERROR_IS_FATAL ANY OUTPUT_QUIET)
  execute_process(COMMAND gzip -9nf \"\${share}/man/man1/osteon.1\" COMMAND_ERROR_IS_FATAL ANY)
  file(CREATE_LINK osteon.1.gz \"\${share}/man/man1/osteon-studies.1.gz\" SYMBOLIC)
  foreach(shell file IN ZIP_LISTS shells completions)
    get_filename_component(folder \"\${file}\" DIRECTORY)
    file(MAKE_DIRECTORY \"\${folder}\")
    execute_process(COMMAND \${command} completion \${shell} OUTPUT_FILE \"\${file}\" COMMAND_ERROR_IS_FATAL ANY)
  endforeach()
" COMPONENT osteon)
install(FILES ${packaging}/osteon@.service DESTINATION lib/systemd/system COMPONENT osteon)
install(FILES ${packaging}/osteon.sysusers DESTINATION lib/sysusers.d RENAME osteon.conf COMPONENT osteon)
# below another prefix than /usr nothing reads it: docs/set_up.md
install(CODE "
  set(etc \"\${CMAKE_INSTALL_PREFIX}/etc\")
  if(CMAKE_INSTALL_PREFIX STREQUAL \"/usr\")
    set(etc /etc)
  endif()
  file(INSTALL \"${packaging}/osteon.conf\" DESTINATION \"\${etc}/security/limits.d\")
" COMPONENT osteon)
install(FILES ${packaging}/60-osteon.rules DESTINATION lib/udev/rules.d COMPONENT osteon)

# --- the library
install(TARGETS osteon_plugin EXPORT osteon-targets
  LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT library NAMELINK_COMPONENT development)
# scenes, tools and materials stand in the package of the command; the library alone needs a packing, balls or these
install(FILES plugin/include/osteon.h plugin/include/osteon_host.h plugin/include/osteon_host_axes.h
  plugin/include/osteon_host_plan.h DESTINATION ${CMAKE_INSTALL_INCLUDEDIR} COMPONENT development)
install(EXPORT osteon-targets NAMESPACE osteon:: DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/osteon COMPONENT development)
file(WRITE ${PROJECT_BINARY_DIR}/osteon-config.cmake "include(\"\${CMAKE_CURRENT_LIST_DIR}/osteon-targets.cmake\")\n")
write_basic_package_version_file(${PROJECT_BINARY_DIR}/osteon-config-version.cmake COMPATIBILITY SameMajorVersion)
install(FILES ${PROJECT_BINARY_DIR}/osteon-config.cmake ${PROJECT_BINARY_DIR}/osteon-config-version.cmake
  DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/osteon COMPONENT development)
file(RELATIVE_PATH prefix_from_pkgconfig /prefix/${CMAKE_INSTALL_LIBDIR}/pkgconfig /prefix)
configure_file(${packaging}/osteon.pc.in ${PROJECT_BINARY_DIR}/osteon.pc @ONLY)
install(FILES ${PROJECT_BINARY_DIR}/osteon.pc DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig COMPONENT development)
install(DIRECTORY plugin/python/osteon DESTINATION lib/python3/dist-packages COMPONENT development PATTERN "__pycache__" EXCLUDE)
install(DIRECTORY plugin/examples/ DESTINATION share/doc/libosteon-dev/examples COMPONENT development)

# --- what Debian wants of every package
find_program(gzip gzip REQUIRED)
execute_process(COMMAND ${gzip} -9nc ${packaging}/changelog OUTPUT_FILE ${PROJECT_BINARY_DIR}/changelog.gz)
execute_process(COMMAND ${gzip} -9nc ${PROJECT_SOURCE_DIR}/CHANGELOG.md OUTPUT_FILE ${PROJECT_BINARY_DIR}/CHANGELOG.md.gz)
file(STRINGS ${packaging}/changelog newest LIMIT_COUNT 1)
if(NOT newest MATCHES "^osteon \\(${PROJECT_VERSION}\\) ")
  message(FATAL_ERROR "plugin/packaging/changelog: found \"${newest}\", accepted an entry of ${PROJECT_VERSION} first")
endif()
install(FILES ${PROJECT_BINARY_DIR}/CHANGELOG.md.gz DESTINATION share/doc/osteon COMPONENT osteon)
foreach(package osteon:osteon library:libosteon0 development:libosteon-dev)
  string(REPLACE ":" ";" package ${package})
  list(GET package 0 component)
  list(GET package 1 name)
  install(FILES ${packaging}/copyright ${PROJECT_BINARY_DIR}/changelog.gz DESTINATION share/doc/${name} COMPONENT ${component})
endforeach()

# --- Debian packages: cpack -G DEB --config BUILD/CPackConfig.cmake
set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_CONTACT "The Osteon developers <developers@osteon.dev>")
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_INSTALL_DEFAULT_DIRECTORY_PERMISSIONS OWNER_READ OWNER_WRITE OWNER_EXECUTE GROUP_READ GROUP_EXECUTE
  WORLD_READ WORLD_EXECUTE)
set(CPACK_STRIP_FILES ON)
set(CPACK_COMPONENTS_ALL osteon library development)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PACKAGE_GENERATE_SHLIBS ON)
set(CPACK_DEBIAN_ENABLE_COMPONENT_DEPENDS OFF)
set(CPACK_DEBIAN_OSTEON_PACKAGE_NAME osteon)
set(CPACK_DEBIAN_OSTEON_PACKAGE_SECTION science)
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION ON)
set(CPACK_DEBIAN_OSTEON_PACKAGE_CONTROL_EXTRA ${packaging}/postinst ${packaging}/prerm ${packaging}/postrm
  ${packaging}/conffiles)
set(CPACK_DEBIAN_OSTEON_PACKAGE_RECOMMENDS "mesa-vulkan-drivers, fonts-dejavu-core")
set(CPACK_COMPONENT_OSTEON_DESCRIPTION "haptic controller of a hip-reaming robot cell
 Runs a real or simulated cell: servo loop, cutting simulation, guard, console,
 reports, and the studies that tune it.")
set(CPACK_DEBIAN_LIBRARY_PACKAGE_NAME libosteon0)
set(CPACK_DEBIAN_LIBRARY_PACKAGE_SECTION libs)
set(CPACK_DEBIAN_LIBRARY_PACKAGE_CONTROL_EXTRA ${packaging}/triggers)
set(CPACK_DEBIAN_LIBRARY_PACKAGE_RECOMMENDS "osteon")
set(CPACK_COMPONENT_LIBRARY_DESCRIPTION "cutting engine for haptics (shared library)
 Bone that gives way to reamers, drills and burrs, with the forces for a haptic
 device's loop and the carved surface as a mesh.")
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_NAME libosteon-dev)
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_SECTION libdevel)
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_DEPENDS "libosteon0 (= ${PROJECT_VERSION}), python3:any")
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_SUGGESTS "osteon, python3-numpy")
set(CPACK_COMPONENT_DEVELOPMENT_DESCRIPTION "cutting engine for haptics (header, Python module)
 The C header of libosteon, its CMake package and pkg-config file, the Python
 module, and examples.")
include(CPack)
