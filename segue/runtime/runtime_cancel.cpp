// SPDX-License-Identifier: Apache-2.0
#include <segue/base/text.hpp>
#include <segue/runtime/runtime_implementation.hpp>

#include <utility>

namespace segue::runtime {

using detail::PendingRequest;
using detail::Transaction;

namespace {

std::string_view name_of_stage(Transaction::Stage stage) {
  switch (stage) {
    case Transaction::Stage::Prepare:
      return "prepare";
    case Transaction::Stage::Commit:
      return "commit";
    case Transaction::Stage::Committed:
    case Transaction::Stage::Retire:
      return "retire";
    case Transaction::Stage::Undo:
      return "undo";
  }
  return "";
}

}  // namespace

Result<std::future<SwitchResult>> Runtime::Implementation::cancel(std::uint64_t request, std::string who) {
  who = who.empty() ? "somebody" : std::move(who);
  std::optional<PendingRequest> withdrawn;
  {
    const Lock lock(mutex);
    if (waiting && (request == 0 || request == waiting->number)) {
      withdrawn.swap(waiting);
    } else if (served && (request == 0 || request == served->number)) {
      return cancel_served(who);
    }
  }
  if (!withdrawn) {
    return fail(ErrorCode::NotFound,
                request == 0 ? "there is nothing to cancel: no request is in progress"
                             : "request " + std::to_string(request) + " is not in progress (any more)");
  }
  log.add(EventKind::RequestCancelled, detail::name_of(withdrawn->request).str(), "by " + who);
  SwitchResult result = cancelled(*withdrawn);
  result.outcome = Outcome::Cancelled;
  result.cancelled_by = who;
  result.from = result.runs = belief.controller().name;
  result.from_version = result.runs_version = belief.version();
  result.error =
      fail(ErrorCode::Cancelled, "cancelled by " + who + " before the request was served", result.to.str());
  journal.ended(std::as_const(result));
  std::promise<SwitchResult> told;
  told.set_value(result);
  answer(*withdrawn, std::move(result));
  return told.get_future();
}

Result<std::future<SwitchResult>> Runtime::Implementation::cancel_served(const std::string& who) {
  if (served->ended) {
    return fail(ErrorCode::InvalidState, "it has just ended", served->to.str());
  }
  const bool is_new = !served->cancelled_by;
  if (transaction) {
    auto accepted = transaction->cancel(who);
    if (!accepted) {
      return std::move(accepted.error());
    }
    served->cancelled_by = std::move(*accepted);
  } else if (is_new) {
    served->cancelled_by = who;  // it is being planned
  }
  if (is_new) {
    log.add(EventKind::RequestCancelled, served->to.str(), "by " + who);
  }
  return served->cancelled.emplace_back().get_future();
}

void Runtime::Implementation::cancel_requests_of(std::uint64_t lease, const std::string& who) {
  std::vector<std::uint64_t> open;
  {
    const Lock lock(mutex);
    if (served && served->lease == lease) {
      open.push_back(served->number);
    }
    if (waiting && waiting->options.lease == lease) {
      open.push_back(waiting->number);
    }
  }
  for (const std::uint64_t number : open) {
    static_cast<void>(cancel(number, who));  // what is past its commit goes on to its end
  }
}

std::vector<OpenRequest> Runtime::Implementation::open_requests() const {
  const Lock lock(mutex);
  std::vector<OpenRequest> open;
  if (served && !served->ended) {
    open.push_back({served->number, served->to, served->who,
                    transaction ? name_of_stage(transaction->stage()) : "planning",
                    served->cancelled_by.value_or("")});
  }
  if (waiting) {
    open.push_back({waiting->number, detail::name_of(waiting->request), waiting->options.who, "waiting", ""});
  }
  return open;
}

}  // namespace segue::runtime
