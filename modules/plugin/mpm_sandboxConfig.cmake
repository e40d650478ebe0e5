# find_package(mpm_sandbox): target mpm_sandbox::plugin (what a plugin is compiled with), program mpm_sandbox::program,
# functions mpm_add_plugin and mpm_test_plugin.
include(${CMAKE_CURRENT_LIST_DIR}/mpm_sandboxTargets.cmake)
include(${CMAKE_CURRENT_LIST_DIR}/MpmPlugin.cmake)
