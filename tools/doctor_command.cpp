// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
// bpa doctor: what is wrong with frames, a library, a running server and this machine.
#include <algorithm>
#include <cstdio>

#include <nlohmann/json.hpp>

#include "core/base/concat.hpp"
#include "core/doctor/frame_check.hpp"
#include "core/doctor/library_check.hpp"
#include "core/io/file_bytes.hpp"
#include "core/io/model_file.hpp"
#include "tools/doctor.hpp"
#include "tools/search.hpp"

namespace bpa::cli {
namespace {

constexpr std::size_t kMaxFrames = 8;  // of a data set, evenly spread: faults repeat

struct DoctorArguments {
  CommonOptions common;
  DetectArguments input;
  std::string library, config, sensor, json;
  bool server = false;
  bool localhost = false;
  double timeout_s = 5;
  ClientOptions client;
};

const char* name_of(doctor::Severity severity) {
  return severity == doctor::Severity::error ? "error" : "warning";
}

/// What was found, and of what.
class Report {
 public:
  /// The same trouble of several subjects is one entry.
  void add(const std::string& subject, const doctor::Findings& findings) {
    for (const doctor::Finding& finding : findings) {
      const auto same = std::ranges::find_if(entries_, [&](const Entry& entry) {
        return entry.finding.what == finding.what && entry.finding.severity == finding.severity;
      });
      if (same == entries_.end()) {
        entries_.push_back({subject, finding});
      } else {
        ++same->more;
      }
    }
  }
  /// That something was looked at, for people.
  void looked_at(const std::string& what) { seen_ += (seen_.empty() ? "" : ", ") + what; }

  void print() const {
    if (entries_.empty()) std::printf("nothing found (%s)\n", seen_.c_str());
    for (const auto& [subject, finding, more] : entries_) {
      std::printf("%s: %s: %s: %s%s\n  remedy: %s\n", name_of(finding.severity), subject.c_str(),
                  finding.what.c_str(), finding.why.c_str(),
                  more > 0 ? concat(" (and ", more, " more)").c_str() : "", finding.remedy.c_str());
    }
    std::fflush(stdout);
  }
  void write(const std::string& path) const {
    nlohmann::json findings = nlohmann::json::array();
    for (const auto& [subject, finding, more] : entries_) {
      findings.push_back({{"severity", name_of(finding.severity)},
                          {"subject", subject},
                          {"what", finding.what},
                          {"why", finding.why},
                          {"remedy", finding.remedy},
                          {"times", more + 1}});
    }
    or_throw(io::write_file(path, nlohmann::json{{"findings", findings}}.dump(
                                      1, ' ', false, nlohmann::json::error_handler_t::replace) +
                                      "\n"));
  }
  std::size_t size() const { return entries_.size(); }

 private:
  struct Entry {
    std::string subject;
    doctor::Finding finding;
    int more = 0;  ///< Other subjects with it.
  };
  std::vector<Entry> entries_;
  std::string seen_;
};

/// Frames whose depth is as it came, each with its name.
std::vector<Input> read_frames(const DoctorArguments& a, Report& report) {
  std::vector<Input> frames;
  const auto try_to_read = [&](const std::string& name, const auto& read) {
    try {
      read();
    } catch (const Failure& failure) {
      report.add(name, {{doctor::Severity::error, "the frame cannot be read", failure.what(),
                         "Give depth, colour and camera file of one camera and one image size. Of "
                         "a sensor, bpa-server --list-devices says what is wrong with it."}});
    }
  };
  std::vector<io::BopFrame> entries;
  if (count_inputs(a.input) > 0) {
    try_to_read("frames", [&] { entries = list_inputs(a.input); });
  }
  const std::size_t step = (entries.size() + kMaxFrames - 1) / kMaxFrames;
  for (std::size_t i = 0; i < entries.size(); i += step) {
    try_to_read(entries[i].depth_path,
                [&] { frames.push_back(read_raw_input(a.input, entries[i])); });
  }
  if (!a.sensor.empty()) {
    try_to_read(a.sensor, [&] {
      frames.push_back({a.sensor, or_throw(frame_of_sensor(a.sensor, a.timeout_s)), {}});
    });
  }
  return frames;
}

std::vector<ModelSource> read_models(const DoctorArguments& a, Report& report) {
  const std::string subject = "library " + a.library;
  auto contents = io::read_library(a.library, a.common.threads);
  if (!contents.ok()) {
    report.add(subject, {{doctor::Severity::error, "it cannot be read", contents.status().message,
                          "Correct --library."}});
    return {};
  }
  for (const io::BrokenModel& broken : contents->broken) {
    report.add(subject, {{doctor::Severity::error, "the model " + broken.name + " cannot be read",
                          broken.reason.message, "Make it again (`bpa model`) or remove it."}});
  }
  if (contents->models.empty() && contents->broken.empty()) {
    report.add(subject, {{doctor::Severity::error, "it is empty", "nothing can be found",
                          "Make models: `bpa model from-mesh`, `from-bop` or `from-scans`."}});
  }
  return std::move(contents->models);
}

void check_library(const DoctorArguments& a, const DetectorOptions& options,
                   const std::vector<Input>& frames, Report& report) {
  const std::vector<ModelSource> models = read_models(a, report);
  report.looked_at(concat(models.size(), " models"));
  const doctor::DetectorLimits limits{options.surface.max_range_m, options.surface.max_width,
                                      options.detect.check.points};
  bool with_color = true;
  for (const Input& input : frames) {
    with_color = with_color && !input.frame.color.empty();
    Frame clean = input.frame;
    clean_depth(clean);
    if (!validate(clean).ok()) continue;
    report.add(input.name, doctor::check_models_in_frame(models, clean, limits));
  }
  report.add("library " + a.library,
             doctor::check_look_alikes(models, with_color, a.common.threads));
}

void run_doctor(const DoctorArguments& a) {
  const int inputs = count_inputs(a.input) + !a.sensor.empty();
  if (inputs > 1) {
    throw CLI::ValidationError("frames", "give one of --pcd, --depth, --bop and --sensor");
  }
  const DetectorOptions options = read_detector_options(a.config);
  Report report;
  const std::vector<Input> frames = read_frames(a, report);
  if (inputs > 0) report.looked_at(concat(frames.size(), " frames"));
  for (const Input& input : frames) {
    report.add(input.name,
               doctor::check_frame(input.frame, options.surface.max_range_m, a.common.threads));
  }
  if (!a.library.empty()) check_library(a, options, frames, report);
  if (a.server || (inputs == 0 && a.library.empty())) {
    report.looked_at("server and machine");
    ClientOptions client = a.client;
    client.timeout = std::chrono::milliseconds(static_cast<int>(1000 * a.timeout_s));
    client.range_from_environment = !a.localhost;
    client.range = DiscoveryRange::localhost;
    const RunningFindings found = check_running_server(client);
    report.add("server " + client.server_namespace, found.server);
    report.add("machine", found.machine);
  }
  report.print();
  if (!a.json.empty()) report.write(a.json);
  if (report.size() > 0) {
    throw Failure({StatusCode::invalid_argument,
                   concat(report.size(), report.size() == 1 ? " finding" : " findings")});
  }
}

}  // namespace

void add_doctor_command(CLI::App& program) {
  const auto [command, a] = add_command(
      program, "doctor",
      "Say what is wrong with frames, a library, a running server and this machine, and what to "
      "do; exits with 1 if something is. Without frames and library it asks the server",
      run_doctor);
  add_input_options(command, a.input);
  add_option(command, "--sensor", a.sensor,
             "Take a frame from openni2, openni2:URI, FILE.oni, bop:FOLDER or bag:PATH", "URI");
  add_option(command, "--library", a.library, "Folder of the model library", "DIR");
  add_option(command, "--config", a.config, "Settings of the detector (detector.yaml)", "FILE");
  command.add_flag("--server", a.server, "Ask the running server, beside frames or a library");
  add_option(command, "--domain", a.client.domain, "DDS domain; ROS_DOMAIN_ID if not given", "N")
      ->check(CLI::Range(0, 232));
  add_option(command, "--namespace", a.client.server_namespace, "ROS namespace of the server");
  command.add_flag("--localhost", a.localhost, "Look for the server on this machine only");
  add_option(command, "--keystore", a.client.keystore,
             "DDS Security: folder that bpa-server --make-keystore or SROS 2 made", "DIR");
  add_option(command, "--enclave", a.client.enclave, "Whose keys of the keystore to use", "NAME");
  add_option(command, "--timeout", a.timeout_s, "Longest wait for a server or a sensor, seconds")
      ->check(CLI::Range(0.1, 600.0));
  add_option(command, "--json", a.json, "Write what was found as JSON", "FILE");
}

}  // namespace bpa::cli
