#pragma once
// These functions read and write the columns of arrays and parameter blocks, and find where a node lies.

#include "backends/device/kernels/arguments.hpp"
#include "backends/device/kernels/fields.hpp"
#include "backends/device/kernels/stopping.hpp"
#include "backends/device/kernels/team.hpp"
#include "kernel/functor.hpp"

namespace mpm::device {

template <int N, class T>
MPM_HD Vec<N, T> load(const T* array, int stride, int index) {
  Vec<N, T> r;
  for (int k = 0; k < N; ++k) r[k] = array[k * stride + index];
  return r;
}
template <int N, class T>
MPM_HD void store(T* array, int stride, int index, const Vec<N, T>& value) {
  for (int k = 0; k < N; ++k) array[k * stride + index] = value[k];
}
template <int D, class T>
MPM_HD Mat<D, T> load_matrix(const T* array, int stride, int index) {
  Mat<D, T> r;
  for (int k = 0; k < D * D; ++k) r.m[k] = array[k * stride + index];
  return r;
}
template <int D, class T>
MPM_HD void store_matrix(T* array, int stride, int index, const Mat<D, T>& value) {
  for (int k = 0; k < D * D; ++k) array[k * stride + index] = value.m[k];
}

/// Whether a value is finite.
MPM_HD bool is_number(double value) {
  return value - value == 0;
}

/// Loads the corners of a particle's domain, [corner][D].
template <int D, class T>
MPM_HD void load_corners(const T* array, int stride, int index, Vec<D, T>* corners) {
  for (int c = 0; c < 1 << D; ++c)
    for (int a = 0; a < D; ++a) corners[c][a] = array[(c * D + a) * stride + index];
}
template <int D, class T>
MPM_HD void store_corners(T* array, int stride, int index, const Vec<D, T>* corners) {
  for (int c = 0; c < 1 << D; ++c)
    for (int a = 0; a < D; ++a) array[(c * D + a) * stride + index] = corners[c][a];
}

/// The number of scalars of a functor's State, which are exactly those declared, in order.
template <class State, class T>
inline constexpr int scalars_of = __is_empty(State) ? 0 : static_cast<int>(sizeof(State) / sizeof(T));

template <class State, class T, int Count = scalars_of<State, T>>
MPM_HD State load_state(const T* array, int stride, int index) {
  State state{};
  T* flat = reinterpret_cast<T*>(&state);
  for (int k = 0; k < Count; ++k) flat[k] = array[k * stride + index];
  return state;
}
template <class State, class T, int Count = scalars_of<State, T>>
MPM_HD void store_state(T* array, int stride, int index, const State& state) {
  const T* flat = reinterpret_cast<const T*>(&state);
  for (int k = 0; k < Count; ++k) array[k * stride + index] = flat[k];
}

/// Loads what a particle keeps of its transfer.
template <class Scene, class T = typename Scene::Scalar>
MPM_HD auto transfer_state(const ParticleArrays<T>& particles, int p) {
  using State = typename Scene::Transfer::template State<Scene::dimension, T>;
  if constexpr (scalars_of < State, T >> 0)
    return load_state<State>(particles.field[Scene::Particle::transfer_state], particles.stride, p);
  else
    return State{};
}
template <class Scene, class State, class T = typename Scene::Scalar>
MPM_HD void store_transfer_state(const ParticleArrays<T>& particles, int p, const State& state) {
  if constexpr (scalars_of < State, T >> 0)
    store_state(particles.field[Scene::Particle::transfer_state], particles.stride, p, state);
}

/// Reads the host's block of doubles as the functor's struct; the pointer may be null for a functor without parameters.
template <class F>
MPM_HD typename F::Parameters parameters_of(const double* block) {
  if constexpr (__is_empty(typename F::Parameters))
    return {};
  else
    return *reinterpret_cast<const typename F::Parameters*>(block);
}

/// Calls body(block) for the blocks with particles, which the teams take in turn: there may be fewer teams than blocks.
template <class T, class Body>
MPM_HD void for_each_block(const Team& team, const Arguments<T>& a, Body body) {
  for (int block = team.block(); block < *a.blocks.active; block += a.teams) body(block);
}

/// The index of the node at these coordinates; ghosts have negative ones.
template <int D, class T>
MPM_HD int node_index(const Arguments<T>& a, const int* node) {
  int index = node[D - 1] + a.padding[D - 1];
  for (int c = D - 2; c >= 0; --c) index = index * a.extent[c] + node[c] + a.padding[c];
  return index;
}

}  // namespace mpm::device
