// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include <chrono>
#include <iostream>
#include <memory>
#include <vector>

#include "client/cli/commands.hpp"
#include "client/cli/frame_view.hpp"
#include "client/cli/options.hpp"
#include "client/cli/output.hpp"

namespace bpa::cli {
namespace {

struct DetectCommand {
  FrameFiles files;
  Restriction restriction;
  DetectQuery query;
  std::string priors;
  std::string json;
  int top = 5;
  double wait_s = 60;
};

Status report(const Result<DetectionSet>& found, const DetectCommand& command,
              std::vector<DetectionSet>& sets) {
  if (!found.ok()) return found.status();
  print_detections(std::cout, *found, command.top);
  std::cout.flush();
  sets.push_back(*found);
  return {};
}

Status detect(Client client, DetectCommand& command) {
  auto priors = read_priors(command.priors);
  if (!priors.ok()) return priors.status();
  command.query.priors = std::move(priors).value();
  const std::chrono::milliseconds wait(static_cast<long>(1000 * command.wait_s));
  std::vector<DetectionSet> sets;
  if (command.files.empty()) {
    if (Status s = report(client.detect(command.query, wait), command, sets); !s.ok()) return s;
  } else {
    const auto entries = list_frames(command.files);
    if (!entries.ok()) return entries.status();
    for (const io::BopFrame& entry : *entries) {
      if (interrupted()) return Status(StatusCode::unavailable, "interrupted");
      const auto frame = load_frame(entry, command.restriction, 0);
      if (!frame.ok()) return frame.status();
      const auto found = client.detect_in(view_of(*frame), command.query, wait);
      if (Status s = report(found, command, sets); !s.ok()) return s;
    }
  }
  return write_results(command.json, sets);
}

}  // namespace

void add_detect(CLI::App& program, Common& common) {
  CLI::App* sub = program.add_subcommand(
      "detect",
      "ask for one search: of frames from disk, or of the next one of the server's camera");
  auto command = std::make_shared<DetectCommand>();
  add_frame_options(*sub, command->files);
  add_restriction_options(*sub, command->restriction);
  sub->add_option("--models", command->query.models, "names of models; default all")
      ->delimiter(',');
  sub->add_option("--top-k", command->query.top_k, "interpretations wanted; default the server's")
      ->check(CLI::Range(1, 100));
  sub->add_option("--budget-ms", command->query.budget_ms, "report the best so far after this long")
      ->check(CLI::NonNegativeNumber);
  sub->add_option("--seed", command->query.seed, "same frame and seed: same answer");
  add_priors_option(*sub, command->priors);
  sub->add_option("--json", command->json, "write all results to this file");
  sub->add_option("--top", command->top, "interpretations to print")->capture_default_str();
  sub->add_option("--wait", command->wait_s, "seconds to wait for an answer")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  sub->callback([command, &common] {
    const Status status = check_frame_options(command->files, false);
    if (!status.ok()) throw CLI::ValidationError("detect", status.message);
    if (!command->restriction.empty() && command->files.empty()) {
      throw CLI::ValidationError("detect", "--roi and --mask need frames from disk");
    }
    common.run([&](Client client) { return detect(std::move(client), *command); });
  });
}

}  // namespace bpa::cli
