#include "output/summary_value.hpp"

#include <limits>
#include <sstream>

namespace mpm::output {

const Json* value_at(const Json& summary, const std::string& path) {
  if (path.starts_with('/')) {
    try {
      return &summary.at(Json::json_pointer(path));
    } catch (const Json::exception&) {  // the path names no place, or is no pointer
      return nullptr;
    }
  }
  const Json* value = &summary;
  std::stringstream names(path);
  for (std::string name; std::getline(names, name, '.');) {
    if (!value->is_object() || !value->contains(name)) return nullptr;
    value = &(*value)[name];
  }
  return value;
}

double number_at(const Json& summary, const std::string& path) {
  const Json* value = path.empty() ? nullptr : value_at(summary, path);
  return value && value->is_number() ? value->get<double>() : std::numeric_limits<double>::quiet_NaN();
}

}  // namespace mpm::output
