#pragma once
// The part of read_study that reads axes and what they set.

#include <map>
#include <string>
#include <vector>

#include "experiment/parameter.hpp"
#include "study/study.hpp"

namespace mpm::study {

/// What reading a study collects beside its problems.
struct StudyContext : ReadContext {
  std::map<std::string, std::string> places;  ///< those of Study::places

  /// Keeps the place of an override that a value of the file makes.
  void keep_place(const std::string& override_or_pointer, const Node& value);
};

/// The node's value as JSON that reads back the same.
OrderedJson json_of(const Node& node);

/// Reads "axes": an object by pointer or name, or a list of objects with "pointer" or "name".
std::vector<Axis> read_axes(const Node& node, StudyContext& context);

/// Reads an object of values by JSON pointer as overrides, in its order; `pointers` gets the pointers.
std::vector<std::string> read_set(const Node& node, StudyContext& context, std::vector<std::string>& pointers);

/// Records a problem, and returns false, unless `pointer` is one.
bool is_pointer(const std::string& pointer, const Node& at, StudyContext& context);

/// The last word of a pointer that says what it is: "/transfer/type" -> "transfer", "/grid/cell_size" -> "cell size".
std::string word_of(const std::string& pointer);

/// Whether setting `later` overwrites what `earlier` set: it is the same place or one above.
bool overwrites(const std::string& later, const std::string& earlier);

}  // namespace mpm::study
