# This suite's program has backends of its own: those of the program, with faults written into copies of their texts.
# A text that a fault no longer finds stops the configuration, so that no fault is lost unseen.
set(faulty ${CMAKE_CURRENT_BINARY_DIR}/faulty)
set(faulty_files)

# mpm_fault(FILE FROM TO): in the copy of modules/FILE, puts TO in place of FROM, which stands there once.
macro(mpm_fault file from to)
  if(NOT ${file} IN_LIST faulty_files)
    list(APPEND faulty_files ${file})
    file(READ ${PROJECT_SOURCE_DIR}/modules/${file} text_of_${file})
    set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/modules/${file})
  endif()
  mpm_count(found "${text_of_${file}}" "${from}")
  if(NOT found EQUAL 1)
    message(FATAL_ERROR "tests/faults: modules/${file} holds ${found} times, not once: ${from}")
  endif()
  string(REPLACE "${from}" "${to}" text_of_${file} "${text_of_${file}}")
endmacro()

set(now "test::injected == test::Fault")

# The reference backend
set(reference backends/reference)
mpm_fault(${reference}/grid_step.cpp
          "boundary_impulse_, i, momentum_[i] - before);"
          "boundary_impulse_, i, momentum_[i] - before);
    if (${now}::wall) momentum_[i] -= 0.01 * (momentum_[i] - before);")
mpm_fault(${reference}/contact.cpp
          "record(contact_impulse_, standing_contact_impulse_, a, J);"
          "record(contact_impulse_, standing_contact_impulse_, a, (${now}::contact ? 0.5 : 1.0) * J);")
mpm_fault(${reference}/contact.cpp
          "record(contact_impulse_, standing_contact_impulse_, b, -returned);"
          "record(contact_impulse_, standing_contact_impulse_, b, (${now}::contact ? -0.5 : -1.0) * returned);")
mpm_fault(${reference}/contact.cpp
          "record(contact_impulse_, standing_contact_impulse_, a, pair->impulse);"
          "record(contact_impulse_, standing_contact_impulse_, a, (${now}::contact ? 0.5 : 1.0) * pair->impulse);")
mpm_fault(${reference}/contact.cpp
          "record(contact_impulse_, standing_contact_impulse_, b, -pair->returned);"
          "record(contact_impulse_, standing_contact_impulse_, b, (${now}::contact ? -0.5 : -1.0) * pair->returned);")
mpm_fault(${reference}/filter.cpp
          "standing_boundary_impulse_, i, mass_[i] * (velocity_[i] - before));"
          "standing_boundary_impulse_, i, mass_[i] * (velocity_[i] - before));
    if (${now}::wall) velocity_[i] -= 0.01 * (velocity_[i] - before);")
mpm_fault(${reference}/transfers.cpp
          "  scatter_affine(body, momentum_);\n}"
          "  scatter_affine(body, momentum_);
  for (std::size_t i = 0; ${now}::scatter && !remap && i < grid_.size(); ++i)
    if (mass_[i] > 0) return (void)(mass_[i] = 0, momentum_[i].setZero());\n}")
mpm_fault(${reference}/filter.cpp
          "// the momentum stays that of the velocity kept aside"
          "\n  for_each_node([&](std::size_t i) { velocity_[i] *= ${now}::filter ? 1 + 1e-3 : 1; });")
mpm_fault(${reference}/transfers.cpp
          "    gather_moments(body, velocity_);
    const Array before = body.velocity;"
          "    gather_moments(body, velocity_);
    if (${now}::gather) body.gathered_velocity *= 1 - 1e-3;
    if (${now}::strain) body.velocity_gradient *= 0.99;
    const Array before = body.velocity;")

# The cpu backend
set(cpu backends/cpu)
mpm_fault(${cpu}/grid/grid_edges.hpp
          "  v[c] = velocity;\n}"
          "  v[c] = ${now}::wall ? static_cast<T>(v[c] + 0.99 * (velocity - v[c])) : velocity;\n}")
mpm_fault(${cpu}/grid/grid_contact.hpp
          "batch.node[i], c, given);"
          "batch.node[i], c, given * (${now}::contact ? 0.5 : 1.0));")
mpm_fault(${cpu}/cpu_backend.hpp
          "  const Scattered particles = particle_step_->scatter(pass, step);\n"
          "  const Scattered particles = particle_step_->scatter(pass, step);
  for (std::uint32_t node = 0; ${now}::scatter && !pass.remap() && node < grid_.nodes(); ++node)
    if (grid_.quad(motion, 0, node)[3] > 0) {
      grid_.quad(motion, 0, node) = Quad<T>{};
      break;
    }\n")
mpm_fault(${cpu}/grid/grid_filter.hpp
          "  fill_ghosts(time, false);\n  if (records_) book_filter();"
          "  for_each_block([&](int field, std::uint32_t first, double*) {
    for (int k = 0; k < block_nodes; ++k)
      for (int c = 0; c < D; ++c) motion_at(field, first + k)[c] *= records_ && ${now}::filter ? T(1 + 1e-3) : T(1);
  });
  fill_ghosts(time, false);\n  if (records_) book_filter();")
mpm_fault(${cpu}/particles/particle_gather.hpp
          "  gather_chunk(chunk, work, wanted);
  work.clock.lap(Phase::coefficients);"
          "  gather_chunk(chunk, work, wanted);
  for (T& v : work.velocity) v *= ${now}::gather ? T(1 - 1e-3) : T(1);
  for (T& rate : work.gradient_of_velocity) rate *= ${now}::strain ? T(0.99) : T(1);
  work.clock.lap(Phase::coefficients);")

# The device's kernels
set(kernels backends/device/kernels)
mpm_fault(${kernels}/conditions.hpp
          "(velocity[c] - now[c]));\n  });"
          "(velocity[c] - now[c]));
    for (int c = 0; c < D && mpm_fault_now() == 1; ++c)
      a.grid.field[N::velocity][c * a.node_count + node] = now[c] + T(0.99) * (velocity[c] - now[c]);\n  });")
mpm_fault(${kernels}/contact.hpp
          "a.grid, at, given);"
          "a.grid, at, given * (mpm_fault_now() == 2 ? T(0.5) : T(1)));")
mpm_fault(${kernels}/scatter.hpp
          "mass * s.distance[i];\n        }\n      }\n      add(s.node, values);"
          "mass * s.distance[i];\n        }\n      }
      if (mpm_fault_now() != 3 || p != 0 || s.weight > T(0.02)) add(s.node, values);")
mpm_fault(${kernels}/filter.hpp
          "    store(a.grid.field[N::velocity], nodes, node, velocity);\n    if constexpr (N::trial"
          "    for (int c = 0; c < D && mpm_fault_now() == 4; ++c) velocity[c] *= T(1 + 1e-3);
    store(a.grid.field[N::velocity], nodes, node, velocity);\n    if constexpr (N::trial")
mpm_fault(${kernels}/gather.hpp
          "  const auto moments = gathered_moments<Scene>(a, stencil, a.grid.field[N::velocity], before);"
          "  auto moments = gathered_moments<Scene>(a, stencil, a.grid.field[N::velocity], before);
    for (int c = 0; c < D && mpm_fault_now() == 5; ++c) moments.velocity[c] *= T(1 - 1e-3);
    for (int k = 0; k < D * D && mpm_fault_now() == 6; ++k) moments.velocity_gradient(k / D, k % D) *= T(0.99);")

foreach(file ${faulty_files})
  set(text "${text_of_${file}}")
  if(file MATCHES "/kernels/")  # compiled for the host-run device, which finds the function in this program
    string(REPLACE "\nnamespace mpm" "\nextern \"C\" int mpm_fault_now();\n\nnamespace mpm" text "${text}")
  else()
    string(REPLACE "\nnamespace mpm" "\n#include \"faults/injected.hpp\"\n\nnamespace mpm" text "${text}")
  endif()
  set(text_of_${file} "${text}")
  file(GENERATE OUTPUT ${faulty}/${file} CONTENT "${text}")
endforeach()

# Faulty headers are found before the program's. Objects of this program come before those of its libraries.
file(GLOB reference_sources RELATIVE ${PROJECT_SOURCE_DIR}/modules ${PROJECT_SOURCE_DIR}/modules/${reference}/*.cpp)
foreach(source ${reference_sources})
  if(source IN_LIST faulty_files)
    target_sources(${program} PRIVATE ${faulty}/${source})
  else()
    target_sources(${program} PRIVATE ${PROJECT_SOURCE_DIR}/modules/${source})
  endif()
endforeach()
foreach(unit grid particle library)
  foreach(D 2 3)
    foreach(T float double)
      target_sources(${program} PRIVATE ${PROJECT_BINARY_DIR}/modules/${cpu}/${unit}_${D}_${T}.cpp)
    endforeach()
  endforeach()
endforeach()

# The table of the device's headers, as modules/backends/device/CMakeLists.txt makes it.
file(GLOB kernel_headers RELATIVE ${PROJECT_SOURCE_DIR}/modules
     ${PROJECT_SOURCE_DIR}/modules/kernel/*.hpp ${PROJECT_SOURCE_DIR}/modules/operators/*.hpp
     ${PROJECT_SOURCE_DIR}/modules/${kernels}/*.hpp)
set(table)
foreach(header ${kernel_headers})
  if(header IN_LIST faulty_files)
    set(text "${text_of_${header}}")
  else()
    file(READ ${PROJECT_SOURCE_DIR}/modules/${header} text)
  endif()
  string(APPEND table "{\"${header}\", R\"MPM_SOURCE(${text})MPM_SOURCE\"},\n")
endforeach()
file(GENERATE OUTPUT ${faulty}/kernel_headers.inc CONTENT "${table}")
target_sources(${program} PRIVATE ${PROJECT_SOURCE_DIR}/modules/backends/device/compose.cpp)
set_source_files_properties(${PROJECT_SOURCE_DIR}/modules/backends/device/compose.cpp PROPERTIES
                            COMPILE_DEFINITIONS "MPM_KERNEL_HEADERS=\"${faulty}/kernel_headers.inc\"")
target_include_directories(${program} BEFORE PRIVATE ${faulty})
set_target_properties(${program} PROPERTIES ENABLE_EXPORTS ON)
