// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/io/options_yaml.hpp"

#include <algorithm>
#include <cstdlib>
#include <iomanip>
#include <limits>
#include <numeric>
#include <sstream>
#include <utility>

#include <yaml-cpp/yaml.h>

#include "core/base/concat.hpp"
#include "core/io/file_bytes.hpp"
#include "core/io/yaml_text.hpp"

namespace bpa::io {
namespace {

const char* kind_of(const Option::Value& value) {
  constexpr const char* kKinds[] = {"a map of \"key: value\" lines",
                                    "true or false",
                                    "a whole number",
                                    "a number",
                                    "a whole number",
                                    "a text",
                                    "a list of texts, such as [a, b]"};
  return kKinds[value.index()];
}

std::string one_line(const YAML::Node& node) {
  YAML::Emitter text;
  text << YAML::Flow << node;
  return text.c_str();
}

Status at(const std::string& file, const YAML::Mark& mark, const std::string& problem) {
  return invalid_argument(file, ":", mark.line + 1, ": ", problem);
}

std::string last_name(const std::string& path) { return path.substr(path.rfind('.') + 1); }

// The entries called `path`, or by a short name.
std::vector<const Option*> find(const OptionsReading& reading, const std::string& path) {
  std::vector<const Option*> exact, in_short;
  const std::string& below = reading.short_names_below;
  std::string end(1, '.');
  end += path.substr(std::min(below.size(), path.size()));
  for (const Option& option : reading.options) {
    if (option.path == path) exact.push_back(&option);
    const bool named = path.starts_with(below) && option.path.starts_with(below) &&
                       option.path.ends_with(end) && !option.is_group();
    if (named) in_short.push_back(&option);
  }
  return exact.empty() ? in_short : exact;
}

void add_word(const std::string& word, const char* separator, std::string& list) {
  if (!list.empty()) list += separator;
  list += word;
}

// How many letters are to be added, removed or exchanged to get from one word to the other.
std::size_t distance(const std::string& from, const std::string& to) {
  std::vector<std::size_t> row(to.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 0; i < from.size(); ++i) {
    std::size_t before = std::exchange(row[0], i + 1);
    for (std::size_t j = 0; j < to.size(); ++j) {
      const std::size_t exchanged = before + (from[i] != to[j]);
      before = row[j + 1];
      row[j + 1] = std::min({exchanged, before + 1, row[j] + 1});
    }
  }
  return row.back();
}

// The path whose last name is like that of `path`, but for a third of its letters; else empty.
std::string nearest(const OptionsReading& reading, const std::string& path) {
  const std::string name = last_name(path);
  std::size_t least = name.size() / 3 + 1;
  std::string found;
  for (const Option& option : reading.options) {
    const std::size_t far = distance(name, last_name(option.path));
    if (far < least) {
      least = far;
      found = option.path;
    }
  }
  return found;
}

// What to say of a key that is none: where it is, the nearest one, or the keys that there are.
std::string unknown(const OptionsReading& reading, const std::string& path) {
  const std::string group = path.substr(0, path.rfind('.') + 1);
  std::string beside, elsewhere;
  for (const Option& option : reading.options) {
    const bool here =
        option.path.starts_with(group) && option.path.find('.', group.size()) == std::string::npos;
    if (here) add_word(option.path.substr(group.size()), ", ", beside);
    if (last_name(option.path) == last_name(path)) add_word(option.path, " or ", elsewhere);
  }
  if (!elsewhere.empty()) return "unknown key " + path + "; there is " + elsewhere;
  const std::string like = nearest(reading, path);
  if (!like.empty()) return "unknown key " + path + "; the nearest is " + like;
  if (!beside.empty()) return "unknown key " + path + "; the keys are " + beside;
  return "unknown key " + path;
}

// `value` is empty or zero before. Texts and lists may be empty: `key:` with nothing after it.
template <class T>
bool convert(const YAML::Node& node, T& value) {
  if (std::is_class_v<T> && node.IsNull()) return true;
  if (std::is_same_v<T, std::string> && !node.IsScalar()) return false;
  return YAML::convert<T>::decode(node, value);
}

// Reads the value of one field; a value that breaks the rule is not kept.
Status set_value(const Option& option, const YAML::Node& node) {
  return std::visit(
      [&](const auto& target) -> Status {
        using Pointer = std::remove_cvref_t<decltype(target)>;
        if constexpr (!std::is_same_v<Pointer, std::monostate>) {
          std::remove_pointer_t<Pointer> value{};
          if (convert(node, value)) {
            std::swap(*target, value);
            Status status = validate(option);
            if (!status.ok()) std::swap(*target, value);
            return status;
          }
        }
        return invalid_argument(option.path, " is ", one_line(node), "; it must be ",
                                kind_of(option.value));
      },
      option.value);
}

Status set(const OptionsReading& reading, const std::string& path, const YAML::Node& node) {
  const auto found = find(reading, path);
  if (found.size() != 1) return invalid_argument(unknown(reading, path));
  if (Status status = set_value(*found.front(), node); !status.ok()) return status;
  return reading.check ? reading.check() : Status();
}

bool is_group(const OptionsReading& reading, const std::string& path) {
  return std::ranges::any_of(reading.options,
                             [&](const Option& o) { return o.is_group() && o.path == path; });
}

Status apply(const std::string& file, const OptionsReading& reading, const std::string& prefix,
             const YAML::Node& map) {
  if (map.IsNull()) return {};
  const std::string what = prefix.empty() ? "the file" : prefix.substr(0, prefix.size() - 1);
  if (!map.IsMap()) return at(file, map.Mark(), what + " must hold \"key: value\" lines");
  for (const auto& entry : map) {
    if (!entry.first.IsScalar()) {
      return at(file, entry.first.Mark(), what + " must hold \"key: value\" lines");
    }
    const std::string path = prefix + entry.first.as<std::string>();
    if (is_group(reading, path)) {
      if (Status s = apply(file, reading, path + ".", entry.second); !s.ok()) return s;
    } else if (Status s = set(reading, path, entry.second); !s.ok()) {
      return at(file, entry.first.Mark(), s.message);
    }
  }
  return {};
}

// Writes a value behind its key.
struct ValueWriter {
  std::ostream& out;

  void operator()(std::monostate) const {}
  void operator()(const auto* value) const { out << ' ' << *value; }
  // With twelve digits, where these say which number it is.
  void operator()(const double* value) const {
    const std::string twelve = format("%.12g", *value);
    const bool exact = std::strtod(twelve.c_str(), nullptr) == *value;
    out << ' ' << (exact ? twelve : format("%.17g", *value));
  }
  void operator()(const std::string* value) const { out << " \"" << *value << '"'; }
  void operator()(const std::vector<std::string>* values) const {
    out << " [";
    for (const std::string& value : *values) {
      out << (&value == values->data() ? "\"" : ", \"") << value << '"';
    }
    out << ']';
  }
};

}  // namespace

Status read_options(const std::string& path, const OptionsReading& reading) {
  if (!is_file(path)) return not_found(path, ": there is no such file");
  const Result<std::string> text = read_file(path);
  if (!text.ok()) return text.status();
  try {
    return apply(path, reading, "", parse_yaml(*text));
  } catch (const YAML::Exception& error) {
    return at(path, error.mark, "not YAML: " + error.msg);
  }
}

Status set_option(const std::string& assignment, const OptionsReading& reading) {
  const std::size_t equals = assignment.find('=');
  if (equals == std::string::npos || equals == 0) {
    return invalid_argument("\"", assignment, "\" must read group.key=value");
  }
  try {
    return set(reading, assignment.substr(0, equals), parse_yaml(assignment.substr(equals + 1)));
  } catch (const YAML::Exception& error) {
    return invalid_argument("\"", assignment, "\" is not YAML: ", error.msg);
  }
}

std::string value_text(const Option& option) {
  std::ostringstream out;
  out << std::setprecision(12) << std::boolalpha;
  std::visit(ValueWriter{out}, option.value);
  return out.str().erase(0, out.str().empty() ? 0 : 1);
}

std::string description_of(const Option& option) {
  std::istringstream choices{std::string(option.rule.choices)};
  std::string listed, word;
  while (choices >> word) add_word(word, ", ", listed);
  return option.description + (listed.empty() ? "" : " One of " + listed + ".");
}

std::string options_yaml(const std::vector<Option>& options, bool hidden) {
  std::ostringstream out;
  out << std::setprecision(12) << std::boolalpha;
  for (const Option& option : options) {
    const auto depth = std::count(option.path.begin(), option.path.end(), '.');
    const std::string indent(2 * depth, ' ');
    if (option.is_group()) out << (depth == 0 ? "\n" : "");
    out << indent << "# " << description_of(option);
    const std::size_t kind = option.value.index();
    const bool number = kind >= 2 && kind <= 4;
    if (number) out << ' ' << option.rule.min << " to " << option.rule.max << '.';
    out << (option.rule.runtime ? " Also at run time.\n" : "\n") << indent
        << (hidden && !option.is_group() ? "#" : "") << last_name(option.path) << ":";
    std::visit(ValueWriter{out}, option.value);
    out << '\n';
  }
  return out.str();
}

}  // namespace bpa::io
