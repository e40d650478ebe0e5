# The CMake package `mpm_sandbox`, for plugins outside of this tree: from the build folder (mpm_sandbox_DIR=<build>) and
# from an installed tree (bin/mpm, lib/mpm/{plugins,backends}, include/mpm, lib/cmake/mpm_sandbox).
include(CMakePackageConfigHelpers)
set(package_folder lib/cmake/mpm_sandbox)

# What a plugin is compiled with: headers, C++20 and the arithmetic of the program's own plugins.
add_library(mpm_plugin_interface INTERFACE)
target_compile_features(mpm_plugin_interface INTERFACE cxx_std_20)
target_compile_options(mpm_plugin_interface INTERFACE ${mpm_arithmetic_flags} ${mpm_instruction_set})
target_include_directories(mpm_plugin_interface INTERFACE $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}/modules>
                           $<INSTALL_INTERFACE:include/mpm>)
set_target_properties(mpm_plugin_interface PROPERTIES EXPORT_NAME plugin)
set_target_properties(mpm_sandbox PROPERTIES EXPORT_NAME program)

install(TARGETS mpm_plugin_interface mpm_sandbox EXPORT mpm_sandboxTargets RUNTIME DESTINATION bin)
get_property(plugin_targets GLOBAL PROPERTY MPM_PLUGIN_TARGETS)
install(TARGETS ${plugin_targets} LIBRARY DESTINATION lib/mpm/plugins)
get_property(backend_targets GLOBAL PROPERTY MPM_BACKEND_LIBRARIES)
install(TARGETS ${backend_targets} LIBRARY DESTINATION lib/mpm/backends)
install(DIRECTORY modules/kernel DESTINATION include/mpm FILES_MATCHING PATTERN *.hpp)
install(FILES modules/plugin/abi.h modules/plugin/extensions.h modules/plugin/sdk.hpp modules/plugin/tables.hpp
        DESTINATION include/mpm/plugin)
install(DIRECTORY modules/plugin/sdk DESTINATION include/mpm/plugin FILES_MATCHING PATTERN *.hpp)
install(EXPORT mpm_sandboxTargets NAMESPACE mpm_sandbox:: DESTINATION ${package_folder})
install(FILES LICENSE DESTINATION share/doc/mpm_sandbox)

# Both trees hold the same three files beside their targets.
export(EXPORT mpm_sandboxTargets NAMESPACE mpm_sandbox:: FILE ${PROJECT_BINARY_DIR}/mpm_sandboxTargets.cmake)
write_basic_package_version_file(${PROJECT_BINARY_DIR}/mpm_sandboxConfigVersion.cmake COMPATIBILITY SameMinorVersion)
configure_file(modules/plugin/mpm_sandboxConfig.cmake ${PROJECT_BINARY_DIR}/mpm_sandboxConfig.cmake COPYONLY)
configure_file(modules/plugin/MpmPlugin.cmake ${PROJECT_BINARY_DIR}/MpmPlugin.cmake COPYONLY)
install(FILES ${PROJECT_BINARY_DIR}/mpm_sandboxConfigVersion.cmake modules/plugin/mpm_sandboxConfig.cmake
        modules/plugin/MpmPlugin.cmake DESTINATION ${package_folder})
