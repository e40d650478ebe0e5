# mpm_add_plugin(KIND ID SOURCES... HEADER functor.hpp): a loadable plugin that carries the text of its functor, as target
# KIND_ID and file plugins/KIND_ID.so of the build folder. Serves the sandbox itself and projects that found the package.
# The text is embedded, so a GPU backend composes kernels at run time without looking for files.
function(mpm_add_plugin kind id)
  cmake_parse_arguments(ARG "" "HEADER" "SOURCES" ${ARGN})
  if(NOT kind MATCHES "^(shape|transfer|filter|contact|material)$")
    message(FATAL_ERROR "mpm_add_plugin: \"${kind}\" is no kind; kinds are shape, transfer, filter, contact, material")
  endif()
  if(NOT ARG_SOURCES OR NOT ARG_HEADER)
    message(FATAL_ERROR "mpm_add_plugin(${kind} ${id}): SOURCES and HEADER are needed")
  endif()
  set(target ${kind}_${id})
  add_library(${target} MODULE ${ARG_SOURCES})
  set(embedded ${CMAKE_CURRENT_BINARY_DIR}/${target}_source.inc)
  get_filename_component(header ${ARG_HEADER} ABSOLUTE)
  set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${header})
  file(READ ${header} text)
  file(CONFIGURE OUTPUT ${embedded} CONTENT "R\"MPM_SOURCE(@text@)MPM_SOURCE\"\n" @ONLY)
  target_compile_definitions(${target} PRIVATE MPM_EMBEDDED_SOURCE="${embedded}")
  if(TARGET mpm_flags)  # inside the sandbox: warnings and sanitizers too
    target_link_libraries(${target} PRIVATE mpm_flags)
  else()
    target_link_libraries(${target} PRIVATE mpm_sandbox::plugin)
  endif()
  set_target_properties(${target} PROPERTIES PREFIX "" SUFFIX .so OUTPUT_NAME ${target} CXX_EXTENSIONS OFF
                        CXX_VISIBILITY_PRESET hidden LIBRARY_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/plugins)
  set_property(GLOBAL APPEND PROPERTY MPM_PLUGIN_TARGETS ${target})
endfunction()

# mpm_test_plugin(KIND ID): a CTest entry KIND_ID.conformance that runs `mpm test-plugin` on a plugin of this project.
function(mpm_test_plugin kind id)
  add_test(NAME ${kind}_${id}.conformance COMMAND mpm_sandbox::program test-plugin $<TARGET_FILE:${kind}_${id}>)
endfunction()
