// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "server/options.hpp"

#include "core/base/concat.hpp"
#include "core/io/options_yaml.hpp"
#include "core/pipeline/views.hpp"
#include "idl/wire/names.hpp"
#include "server/web/access.hpp"

namespace bpa::server {
namespace {

struct Choice {
  const char* field;
  const std::string& value;
  std::vector<std::string> choices;
};

Status check(const Choice& choice) {
  std::string rule;
  for (const std::string& word : choice.choices) {
    if (choice.value == word) return {};
    rule += (rule.empty() ? "" : ", ") + word;
  }
  return invalid_argument(std::string(choice.field) + " is \"" + choice.value +
                          "\"; it must be one of " + rule);
}

/// Its name is a part of topic names.
Status check_group(const GroupOptions& group) {
  const Status status = wire::validate_full_name("/" + group.name);
  if (status.ok() && group.name.find('/') == std::string::npos) return {};
  return invalid_argument("group.name is \"", group.name,
                          "\"; it must have letters, digits and '_', and not begin with a digit");
}

Status check_views(const ServerOptions& options) {
  const std::size_t cameras = options.input.views.size();
  if (cameras == 0) return {};
  if (cameras < 2 || cameras > kMostViews) {
    return invalid_argument("input.views names ", cameras, " cameras; it must name 2 to ",
                            kMostViews, ", or none");
  }
  if (!options.tracking.fixed_frame.empty()) return {};
  return invalid_argument(
      "input.views names cameras and tracking.fixed_frame is empty; set the frame of /tf that "
      "results are in");
}

io::OptionsReading reading_into(ServerOptions& options) {
  return {options_of(options), "detector.", [&options] { return validate(options); }};
}

}  // namespace

Status validate(const ServerOptions& options) {
  Status status = bpa::validate<ServerOptions>(options);
  if (status.ok()) status = camera::check(options.capture);
  const Choice choices[] = {
      {"network.range",
       options.network.range,
       {"environment", "subnet", "localhost", "humble_localhost", "off"}},
      {"network.graph_layout", options.network.graph_layout, {"automatic", "humble", "iron"}},
      {"input.color_transport", options.input.color_transport, {"raw", "compressed"}},
      {"input.depth_transport",
       options.input.depth_transport,
       {"raw", "compressed", "compressedDepth"}},
      {"log.level", options.log.level, {"debug", "info", "warning", "error"}}};
  if (status.ok() && options.node.use_sim_time && !options.capture.source.empty()) {
    status = invalid_argument(
        "node.use_sim_time is true and capture.source is \"", options.capture.source,
        "\"; a camera of the server's own has this machine's time: set one of them alone");
  }
  if (status.ok()) status = check_group(options.group);
  if (status.ok()) status = check_views(options);
  if (status.ok() && !options.web.listen.empty()) {
    status = web::parse_listen(options.web.listen).status();
  }
  for (const Choice& choice : choices) {
    if (status.ok()) status = check(choice);
  }
  return status;
}

Status load_options(const std::string& path, ServerOptions& options) {
  ServerOptions changed = options;
  Status status = io::read_options(path, reading_into(changed));
  if (status.ok()) options = changed;
  return status;
}

Status set_option(const std::string& assignment, ServerOptions& options) {
  ServerOptions changed = options;
  Status status = io::set_option(assignment, reading_into(changed));
  if (status.ok()) options = changed;
  return status;
}

std::string to_yaml(const ServerOptions& options, bool with_detector) {
  ServerOptions copy = options;
  std::vector<Option> shown = options_of(copy);
  if (!with_detector) {
    std::erase_if(shown, [](const Option& o) { return o.path.rfind("detector", 0) == 0; });
  }
  return io::options_yaml(shown);
}

}  // namespace bpa::server
