# mpm_add_plugin(KIND ID SOURCES... HEADER functor.hpp): a loadable plugin that carries the text of its functor.
# The text is embedded, so a GPU backend composes kernels at run time without looking for files.
function(mpm_add_plugin kind id)
  cmake_parse_arguments(ARG "" "HEADER" "SOURCES" ${ARGN})
  set(target ${kind}_${id})
  add_library(${target} MODULE ${ARG_SOURCES})
  set(embedded ${CMAKE_CURRENT_BINARY_DIR}/${target}_source.inc)
  set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${ARG_HEADER})
  file(READ ${ARG_HEADER} text)
  file(GENERATE OUTPUT ${embedded} CONTENT "R\"MPM_SOURCE(${text})MPM_SOURCE\"\n")
  target_compile_definitions(${target} PRIVATE MPM_EMBEDDED_SOURCE="${embedded}")
  target_link_libraries(${target} PRIVATE mpm_flags)
  set_target_properties(${target} PROPERTIES PREFIX "" OUTPUT_NAME ${target} CXX_VISIBILITY_PRESET hidden
                        LIBRARY_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/plugins)
  set_property(GLOBAL APPEND PROPERTY MPM_PLUGIN_TARGETS ${target})
endfunction()
