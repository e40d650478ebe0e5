#pragma once
// How far apart a node sees two bodies that touch: the contact offset as a function of the shape, the particles a cell,
// where the faces lie, how they are turned against the grid, and how the particles are stretched across them.

#include <vector>

#include "experiment/experiment.hpp"

namespace mpm {

/// Two half spaces of particles in rows that are parallel to their common face. Lengths are in cells.
struct TouchingFaces {
  int particles_per_cell_axis = 2;
  double angle = 0;    ///< between the face's normal and an axis of the grid, radians, in the plane of two axes
  double stretch = 1;  ///< of the particles across the face: rows are so much farther apart
};

/// The distance between the mean positions of both bodies that a node sees, along the face's normal, where the face lies
/// `place` cells from the node: contact detection takes it for the two to touch. The mean over where the node lies along
/// the face: a node then sees a row of particles through its weights summed over the face, which for a shape made of
/// products are the convolution of the weights of the axes, each compressed by the normal's component. Throws
/// std::invalid_argument for a turned face with a shape whose nodes follow no axes, for a number of particles below 1 or
/// a stretch that is not above 0; NaN where a node so far away sees nothing.
std::vector<double> contact_offsets(const Component& shape, const TouchingFaces& faces,
                                    const std::vector<double>& places);

/// The gap that detection by position finds between these faces, though they touch, in cells: it knows of faces along the
/// grid and of particles as they were seeded. Negative where it takes them to overlap; NaN and errors as above.
std::vector<double> found_gaps(const Component& shape, const TouchingFaces& faces, const std::vector<double>& places);

/// The mean of the offsets over faces up to half a cell from the node. NaN where the node sees nothing of one of them.
double mean_contact_offset(const Component& shape, const TouchingFaces& faces);

}  // namespace mpm
