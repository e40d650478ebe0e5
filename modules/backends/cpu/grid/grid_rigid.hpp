#pragma once
// This part of GridStep lets material meet rigid bodies: the nodes near each in batches, one velocity field after another.

#include <limits>

#include "backends/cpu/grid/grid_contact.hpp"

namespace mpm::cpu {

/// The nodes [first, end) of those near a body.
template <int D, class T>
struct GridStep<D, T>::RigidChunk {
  std::size_t body, first, end;
  RigidMotion motion;
};

/// Fills a batch with the nodes of one field that have mass; `listed` gets their places in the list.
template <int D, class T>
void GridStep<D, T>::see_rigid_body(const RigidChunk& chunk, int field, ContactBatch& batch, std::size_t* listed) {
  const std::vector<RigidNode>& nodes = rigid_.nodes(chunk.body);
  const EdgeTable edge = edges_[static_cast<std::size_t>(field)].table();
  for (std::size_t k = chunk.first; k < chunk.end; ++k) {
    const std::int32_t found = grid_.find(nodes[k].at);
    if (found < 0) continue;
    const auto node = static_cast<std::uint32_t>(found);
    const Q& v = motion_at(field, node);
    if (!(v[3] > 0)) continue;
    const ContactField material{&motion_at(field, 0),
                                &grid_.quad(volume_gradient, field, 0),
                                &grid_.quad(mass_position, field, 0),
                                nullptr,
                                nullptr,
                                nullptr,
                                nullptr};
    const ContactGeometry geometry = rigid_contact_geometry(
        material.at(node), edge, nodes[k].surface, rigid_.around(nodes[k]), scene_.experiment.grid.cell_size, D);
    const Vector3 of_body = chunk.motion.velocity_at(nodes[k].arm);
    Q beside = v, body{};
    for (int c = 0; c < D; ++c) beside[c] -= static_cast<T>(of_body[c]);
    body[3] = std::numeric_limits<T>::infinity();
    listed[batch.count] = k;
    batch.add(node, beside, body, geometry, false);
    for (int c = 0; c < D; ++c)  // an infinite mass times no velocity is no number
      batch.momentum_b[c * block_nodes + batch.count - 1] = 0;
  }
}

template <int D, class T>
void GridStep<D, T>::meet_rigid_body(const RigidChunk& chunk, const StepInfo& step, RigidGiven& given) {
  for (int field = 0; field < grid_.fields(); ++field) {
    ContactBatch batch;
    std::size_t listed[block_nodes];
    see_rigid_body(chunk, field, batch, listed);
    if (batch.count == 0) continue;
    call_law(rigid_.law(chunk.body), batch, static_cast<std::uint32_t>(batch.pad(false, false, false, 0)), step.dt,
             false);
    for (int i = 0; i < batch.count; ++i) {
      const RigidNode& node = rigid_.nodes(chunk.body)[listed[i]];
      Q& v = motion_at(field, batch.node[i]);
      Vector3 impulse{};
      for (int c = 0; c < D; ++c) {
        const T J = batch.impulse[c * block_nodes + i];
        T velocity = v[c];
        velocity = struck(velocity, J, T(v[3]));
        v[c] = velocity;
        if (records_) record(contact_impulse, standing_contact, field, batch.node[i], c, J);
        impulse[static_cast<std::size_t>(c)] = J;
      }
      given.give(rigid_.place(node), impulse, chunk.motion.velocity_at(node.arm));
      given.count(batch.status[i], batch.separation[i], batch.dissipated[i]);
    }
  }
}

/// Lets all bodies act one after another, with their velocities at a time, s. Sums are made chunk by chunk, whatever the
/// number of threads.
template <int D, class T>
void GridStep<D, T>::meet_rigid_bodies(double time, const StepInfo& step, ContactGiven& all, ContactRecord& record) {
  for (std::size_t body = 0; body < rigid_.count(); ++body) {
    const std::size_t nodes = rigid_.nodes(body).size(), chunks = (nodes + block_nodes - 1) / block_nodes;
    const RigidMotion motion = rigid_.motion(body, time);
    std::vector<RigidGiven> of_chunks(chunks);
    scene_.team->for_each(chunks, 4, [&](std::size_t i, int) {
      meet_rigid_body({body, i * block_nodes, std::min((i + 1) * block_nodes, nodes), motion}, step, of_chunks[i]);
    });
    RigidGiven given;
    for (const RigidGiven& of_chunk : of_chunks) given.add(of_chunk);
    all.dissipated += given.dissipated, all.driven += given.driven;
    if (notes_reactions_)
      reactions_.add(GivenBySupport::held, scene_.experiment.support_of_rigid_body(body), given.impulse, given.moment);
    given.add_to(record);
  }
}

}  // namespace mpm::cpu
