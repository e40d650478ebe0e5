# Flags and functions that every target of the sandbox shares.

# What decides the arithmetic of a plugin, in this build and outside of it (MpmPackage.cmake).
# Contraction is chosen on purpose: one binary gives one answer whatever the number of threads, and FMA halves the arithmetic.
set(mpm_arithmetic_flags -fno-math-errno -fno-trapping-math -ffp-contract=fast -Wno-psabi)
# The width of a pack of lanes follows from the instruction set (kernel/lanes.hpp).
set(mpm_instruction_set)
if(MPM_NATIVE)
  set(mpm_instruction_set -march=native)
endif()

# GCC 12 writes some loops so that they store relative to a null pointer, takes that for a store to null, after which nothing
# counts, and drops calls of functions that do nothing else (docs/design/mutation.md). It does not where null may be stored to.
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
  list(APPEND mpm_arithmetic_flags -fno-delete-null-pointer-checks)
endif()

add_library(mpm_flags INTERFACE)
target_compile_options(mpm_flags INTERFACE -Wall -Wextra ${mpm_arithmetic_flags})
# GCC 12 warns falsely of std::string sums (GCC bug 105329) and of its own AVX-512 headers (bug 105593).
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
  target_compile_options(mpm_flags INTERFACE -Wno-restrict -Wno-maybe-uninitialized)
  # GCC 14 warns falsely of the branch of std::sort for many elements, which a small array never takes.
  if(CMAKE_CXX_COMPILER_VERSION VERSION_GREATER_EQUAL 14)
    target_compile_options(mpm_flags INTERFACE -Wno-array-bounds)
  endif()
endif()
# Clang warns of each loop marked for lanes that it leaves as it is: that costs speed and is no mistake of the text.
if(CMAKE_CXX_COMPILER_ID MATCHES "Clang")
  target_compile_options(mpm_flags INTERFACE -Wno-pass-failed)
endif()
target_compile_options(mpm_flags INTERFACE ${mpm_instruction_set})
if(MPM_WERROR)
  target_compile_options(mpm_flags INTERFACE -Werror)
endif()
if(MPM_SANITIZE)
  target_compile_options(mpm_flags INTERFACE -fsanitize=${MPM_SANITIZE} -fno-omit-frame-pointer -fno-sanitize-recover=all)
  target_link_options(mpm_flags INTERFACE -fsanitize=${MPM_SANITIZE})
  # GCC's leak sanitizer takes a plugin's thread-local variable that lies 16 bytes into a page for one of an old glibc,
  # reads its extent from the bytes before it and crashes on what it finds. In static storage it does not look there.
  target_compile_options(mpm_flags INTERFACE -ftls-model=initial-exec)
endif()
target_include_directories(mpm_flags INTERFACE ${CMAKE_CURRENT_SOURCE_DIR}/modules)

# Reading these headers is half of the time that most files take to compile. A compiler's cache shares no precompiled headers.
# Not every configuration has been tried with them, so that they are asked for.
set(mpm_common_headers
    <algorithm> <array> <cmath> <cstdint> <cstring> <filesystem> <fstream> <functional> <iostream> <limits> <map> <memory>
    <optional> <set> <span> <sstream> <stdexcept> <string> <string_view> <utility> <vector> <nlohmann/json.hpp>)
if(NOT MPM_PRECOMPILE OR CMAKE_CXX_COMPILER_LAUNCHER)
  set(CMAKE_DISABLE_PRECOMPILE_HEADERS ON)
endif()
file(GENERATE OUTPUT ${CMAKE_BINARY_DIR}/precompiled.cpp CONTENT "// Headers alone are compiled with it.\n")
add_library(mpm_precompiled OBJECT ${CMAKE_BINARY_DIR}/precompiled.cpp)
target_link_libraries(mpm_precompiled PRIVATE mpm_flags)
target_precompile_headers(mpm_precompiled PRIVATE ${mpm_common_headers})

# Most of the time that a file takes to compile goes to the same headers and templates in each: files of a module, and of a
# suite of tests, are therefore compiled together, which takes a third of the time. Who changes them wants them one by one.
set(MPM_FILES_TOGETHER 8 CACHE STRING "Files that are compiled as one (1: each alone, best while they change)")

# mpm_compile_together(TARGET): as many of its files at a time. None may hide a name that another one hides too.
function(mpm_compile_together target)
  if(MPM_FILES_TOGETHER GREATER 1)
    set_target_properties(${target} PROPERTIES UNITY_BUILD ON UNITY_BUILD_BATCH_SIZE ${MPM_FILES_TOGETHER})
  endif()
endfunction()

# mpm_compile_fast(TARGET): code without a loop over particles or nodes in each step gains nothing from more optimisation.
function(mpm_compile_fast target)
  target_compile_options(${target} PRIVATE $<$<CONFIG:Release>:-O1>)
endfunction()

# mpm_add_module(NAME DEPENDS target... [ONLY stem...] [EXCEPT stem...]): a static library of every .cpp in the current
# folder, or of some of them alone.
function(mpm_add_module name)
  cmake_parse_arguments(ARG "" "" "DEPENDS;ONLY;EXCEPT" ${ARGN})
  file(GLOB sources CONFIGURE_DEPENDS *.cpp)
  foreach(stem ${ARG_EXCEPT})
    list(REMOVE_ITEM sources ${CMAKE_CURRENT_SOURCE_DIR}/${stem}.cpp)
  endforeach()
  if(ARG_ONLY)
    list(TRANSFORM ARG_ONLY PREPEND ${CMAKE_CURRENT_SOURCE_DIR}/ OUTPUT_VARIABLE sources)
    list(TRANSFORM sources APPEND .cpp)
  endif()
  add_library(mpm_${name} STATIC ${sources})
  target_link_libraries(mpm_${name} PUBLIC mpm_flags ${ARG_DEPENDS})
  target_precompile_headers(mpm_${name} REUSE_FROM mpm_precompiled)
  mpm_compile_together(mpm_${name})
endfunction()

# The hash of all headers whose classes a backend's library and the program hand to one another.
file(GLOB_RECURSE boundary_headers CONFIGURE_DEPENDS
     ${CMAKE_CURRENT_SOURCE_DIR}/modules/simulation/*.hpp ${CMAKE_CURRENT_SOURCE_DIR}/modules/experiment/*.hpp
     ${CMAKE_CURRENT_SOURCE_DIR}/modules/plan/*.hpp ${CMAKE_CURRENT_SOURCE_DIR}/modules/plugin/*.h*
     ${CMAKE_CURRENT_SOURCE_DIR}/modules/support/*.hpp ${CMAKE_CURRENT_SOURCE_DIR}/modules/backends/device/*.hpp
     ${CMAKE_CURRENT_SOURCE_DIR}/modules/backends/libraries/*.hpp)
set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${boundary_headers})
set(hashes)
foreach(header ${boundary_headers})
  file(SHA256 ${header} hash)
  string(APPEND hashes ${hash})
endforeach()
string(SHA256 hash "${hashes}")
string(SUBSTRING ${hash} 0 16 hash)
set(mpm_hash_of_headers MPM_HASH_OF_HEADERS=0x${hash}ull)

# mpm_add_backend_library(NAME SPACE MAKER LIBRARY...): the library backends/NAME.so of the build folder, as target
# backend_NAME, of what mpm::SPACE::MAKER makes. What it shares with the program it takes from the program, where that has it.
function(mpm_add_backend_library name space maker)
  set(entry ${CMAKE_CURRENT_BINARY_DIR}/${name}_entry.cpp)
  configure_file(${PROJECT_SOURCE_DIR}/modules/backends/libraries/entry.cpp.in ${entry} @ONLY)
  add_library(backend_${name} MODULE ${entry})
  target_compile_definitions(backend_${name} PRIVATE ${mpm_hash_of_headers})
  target_link_libraries(backend_${name} PRIVATE mpm_flags ${ARGN} mpm_simulation mpm_plan mpm_plugin mpm_support)
  set_target_properties(backend_${name} PROPERTIES PREFIX "" SUFFIX .so OUTPUT_NAME ${name}
                        LIBRARY_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/backends)
  set_property(GLOBAL APPEND PROPERTY MPM_BACKEND_LIBRARIES backend_${name})
endfunction()
