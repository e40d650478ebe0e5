# GCC 12 warns falsely of its own AVX-512 headers (GCC bug 105593), which tests of the cpu backend's registers inline.
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU" AND CMAKE_CXX_COMPILER_VERSION VERSION_LESS 13)
  target_compile_options(${program} PRIVATE -Wno-uninitialized)
endif()
