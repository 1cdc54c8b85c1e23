// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "server/group/share_search.hpp"

#include <algorithm>
#include <iterator>
#include <limits>

#include "core/base/concat.hpp"
#include "core/base/guarded.hpp"
#include "core/pipeline/prepare_scene.hpp"
#include "server/group/messages.hpp"

namespace bpa::server::group {

namespace {
namespace msgs = wire::bpa_msgs;
}  // namespace

ShareSearch::ShareSearch(msgs::GroupStep&& begin, std::uint64_t worker, int threads,
                         FindLibrary find, Send send)
    : find_(std::move(find)),
      send_(std::move(send)),
      threads_(threads),
      answer_from_(begin.answer_from),
      begin_(std::move(begin)) {
  answer_.front = begin_.front;
  answer_.search = begin_.search;
  answer_.share = begin_.share;
  answer_.worker = worker;
}

void ShareSearch::run() {
  const Status status = guarded("the search of a share failed", [&] { return search(); });
  if (!status.ok()) refuse(status);
}

void ShareSearch::refuse(const Status& status) {
  msgs::GroupAnswer answer = plain_answer();
  answer.step = std::max(step_, answer_from_);
  answer.status = server::to_message(status);
  send_(answer);
}

msgs::GroupAnswer ShareSearch::plain_answer() const {
  msgs::GroupAnswer answer = answer_;
  answer.step = step_;
  answer.busy_ms = watch_.milliseconds();
  return answer;
}

// None: nothing more is to be done, for the reason status_ if that is a failure.
std::optional<msgs::GroupStep> ShareSearch::next() {
  if (ended_) return {};
  std::optional<msgs::GroupStep> step = steps_.next();
  if (step && step->step != ++step_) return fail(corrupt("steps of a search were lost"));
  ended_ = !step;
  watch_ = Stopwatch();
  return step;
}

std::nullopt_t ShareSearch::fail(Status status) {
  status_ = std::move(status);
  ended_ = true;
  return std::nullopt;
}

void ShareSearch::send(msgs::GroupAnswer&& answer, const LocalSearches& searches) {
  if (ended_ || step_ < answer_from_) return;
  answer.late = searches.late();
  const SearchEffort effort = searches.effort();
  for (const auto& [name, count] : kEffortCounts) answer.effort.push_back(effort.*count);
  send_(answer);
}

// Nothing passes where the search has ended, so that its stages end soon.
detect::Contest ShareSearch::compete(const LocalSearches& searches,
                                     const std::vector<detect::Claim>& claims, int most) {
  msgs::GroupAnswer answer = plain_answer();
  answer.competes = true;
  for (const detect::Claim& claim : claims) answer.claims.push_back(to_message(claim));
  answer.most = most;
  send(std::move(answer), searches);
  std::optional<msgs::GroupStep> step = next();
  if (step && step->kind != msgs::GroupStep::kContest) {
    step = fail(corrupt("a search got a step of kind ", static_cast<int>(step->kind),
                        " where candidates compete"));
  }
  if (!step) return {std::numeric_limits<double>::infinity(), {}};
  detect::Contest contest{step->threshold, {}};
  std::ranges::transform(step->claims, std::back_inserter(contest.claims), claim_from);
  return contest;
}

namespace {

bool all_below(std::size_t limit, const std::vector<std::uint32_t>& numbers) {
  return std::ranges::all_of(numbers, [&](std::uint32_t one) { return one < limit; });
}

// Flags of the models whose numbers are given.
std::vector<std::uint8_t> left_out(const Models& models, const std::vector<std::int32_t>& numbers) {
  std::vector<std::uint8_t> flags;
  for (const auto& model : models) flags.push_back(std::ranges::count(numbers, model->number) > 0);
  return flags;
}

}  // namespace

// What was found since `sent`; after the final stages all.
void ShareSearch::send_found(const LocalSearches& searches, std::vector<std::size_t>& sent) {
  msgs::GroupAnswer answer = plain_answer();
  for (std::size_t i = 0; i < sent.size(); ++i) {
    const detect::Candidates& found = searches.found()[i];
    for (; sent[i] < found.size(); ++sent[i]) {
      answer.candidates.push_back(to_message(found[sent[i]]));
    }
  }
  send(std::move(answer), searches);
}

Status ShareSearch::search() {
  const std::shared_ptr<const SharedLibrary> library = find_(begin_.library);
  if (!library) return not_found("this worker has no library ", begin_.library);
  const Deadline deadline = Deadline::after(begin_.left_ms);
  Result<ShareTask> task = task_of(std::move(begin_), *library);
  if (!task.ok()) return task.status();
  task->request.num_threads = task->facts.threads = threads_;
  const Result<SearchPlan> plan = plan_search(task->options, library->layers, task->facts);
  if (!plan.ok()) return plan.status();
  std::vector<StageTiming> timings;
  const SceneFeatures scene = prepare_scene(task->frame, *plan, deadline, timings);
  const SearchInputs inputs{scene, *plan, library->layers, task->request, task->models};
  LocalSearches* running = nullptr;
  LocalSearches searches(inputs, nullptr, [&](const std::vector<detect::Claim>& claims, int most) {
    return compete(*running, claims, most);
  });
  running = &searches;
  std::vector<std::size_t> sent(task->models.size(), 0);
  while (std::optional<msgs::GroupStep> step = next()) {
    if (!all_below(scene.image.pixels.size(), step->newly_certain) ||
        !all_below(scene.keypoints.size(), step->keypoints) ||
        !all_below(scene.coarse.size(), step->references)) {
      return corrupt("a step of a search names pixels or points outside of the scene");
    }
    if (Status status = run_step(*std::move(step), task->models, searches, sent); !status.ok()) {
      return status;
    }
  }
  return status_;
}

Status ShareSearch::run_step(msgs::GroupStep&& step, const Models& models, LocalSearches& searches,
                             std::vector<std::size_t>& sent) {
  const Deadline until = Deadline::after(step.left_ms);
  if (step.kind == msgs::GroupStep::kExpected) {
    searches.score_expected(until);
  } else if (step.kind == msgs::GroupStep::kRound) {
    searches.run_round({.number = static_cast<int>(step.round),
                        .share = step.part,
                        .points = {{step.keypoints.begin(), step.keypoints.end()},
                                   {step.references.begin(), step.references.end()}},
                        .left_out = left_out(models, step.left_out),
                        .newly_certain = std::move(step.newly_certain),
                        .deadline = until});
  } else if (step.kind == msgs::GroupStep::kFinish) {
    searches.finish(
        {.share = step.part, .newly_certain = std::move(step.newly_certain), .deadline = until});
    std::ranges::fill(sent, 0);
  } else {
    return corrupt("a search got a step of kind ", static_cast<int>(step.kind));
  }
  send_found(searches, sent);
  return {};
}

}  // namespace bpa::server::group
