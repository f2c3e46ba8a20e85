// SPDX-License-Identifier: Apache-2.0
#include <segue/rpc_codecs/tasks_wire.hpp>

#include <algorithm>
#include <utility>

namespace segue::control::detail {

namespace {

using model::TaskId;

void encode_timing(const task::Timing& timing, wire::Timing::Builder builder) {
  builder.setCycles(timing.cycles);
  builder.setMissed(timing.missed);
  builder.setLast(timing.last.count());
  builder.setMean(timing.mean.count());
  builder.setWorst(timing.worst.count());
  builder.setLatencyMean(timing.latency_mean.count());
  builder.setLatencyWorst(timing.latency_worst.count());
  builder.setJitter(timing.jitter.count());
  builder.setCpu(timing.cpu.count());
}

task::Timing decode_timing(wire::Timing::Reader reader) {
  task::Timing timing;
  timing.cycles = reader.getCycles();
  timing.missed = reader.getMissed();
  timing.last = Duration(reader.getLast());
  timing.mean = Duration(reader.getMean());
  timing.worst = Duration(reader.getWorst());
  timing.latency_mean = Duration(reader.getLatencyMean());
  timing.latency_worst = Duration(reader.getLatencyWorst());
  timing.jitter = Duration(reader.getJitter());
  timing.cpu = Duration(reader.getCpu());
  return timing;
}

void encode_histogram(const task::DurationHistogram& histogram, wire::Histogram::Builder builder) {
  const auto& counts = histogram.counts;
  const auto is_used = [](std::uint64_t count) { return count != 0; };
  const auto first = std::find_if(counts.begin(), counts.end(), is_used);
  const auto last = std::find_if(counts.rbegin(), std::make_reverse_iterator(first), is_used).base();
  builder.setFirst(static_cast<std::uint16_t>(first - counts.begin()));
  auto items = builder.initCounts(static_cast<unsigned>(last - first));
  for (unsigned i = 0; i < items.size(); ++i)
    items.set(i, *(first + i));
}

task::DurationHistogram decode_histogram(wire::Histogram::Reader reader) {
  task::DurationHistogram histogram;
  const auto counts = reader.getCounts();
  if (reader.getFirst() + std::size_t{counts.size()} > histogram.counts.size())
    throw WireError(fail(ErrorCode::ParseError, "a histogram has bins that there are not"));
  std::copy(counts.begin(), counts.end(), histogram.counts.begin() + reader.getFirst());
  return histogram;
}

void encode_line(const LogLine& line, wire::LogLine::Builder builder) {
  builder.setNumber(line.number);
  builder.setTime(std::chrono::nanoseconds(line.time.time_since_epoch()).count());
  builder.setLevel(static_cast<std::uint8_t>(line.level));
  builder.setMessage(as_text(line.message));
}

LogLine decode_line(wire::LogLine::Reader reader) {
  using Time = std::chrono::system_clock::time_point;
  const auto since = std::chrono::duration_cast<Time::duration>(std::chrono::nanoseconds(reader.getTime()));
  return {reader.getNumber(), Time(since), enum_from(reader.getLevel(), LogLevel::Error),
          as_string(reader.getMessage())};
}

}  // namespace

void encode(const task_host::TaskReport& report, wire::TaskReport::Builder builder) {
  builder.setId(as_text(report.id.str()));
  builder.setComponent(as_text(report.component.str()));
  builder.setHost(as_text(report.process.host.str()));
  builder.setProcess(as_text(report.process.process.str()));
  builder.setPid(report.pid);
  builder.setState(static_cast<std::uint8_t>(report.state));
  builder.setStandIn(report.stand_in);
  builder.setStateName(as_text(report.state_name));
  builder.setError(as_text(report.error));
  encode(report.activity, builder.initActivity());
  encode_timing(report.timing, builder.initTiming());
}

task_host::TaskReport decode(wire::TaskReport::Reader reader) {
  task_host::TaskReport report;
  report.id = TaskId(as_string(reader.getId()));
  report.component = model::ComponentName(as_string(reader.getComponent()));
  report.process.host = model::HostName(as_string(reader.getHost()));
  report.process.process = model::ProcessName(as_string(reader.getProcess()));
  report.pid = reader.getPid();
  report.state = enum_from(reader.getState(), TaskState::Fatal);
  report.stand_in = reader.getStandIn();
  report.state_name = as_string(reader.getStateName());
  report.error = as_string(reader.getError());
  report.activity = decode(reader.getActivity());
  report.timing = decode_timing(reader.getTiming());
  return report;
}

void encode(const task_host::TaskLevel& level, wire::TaskLevel::Builder builder) {
  builder.setState(static_cast<std::uint8_t>(level.state));
  builder.setStateName(as_text(level.state_name));
  builder.setUpdates(level.updates);
}

task_host::TaskLevel decode(wire::TaskLevel::Reader reader) {
  return {enum_from(reader.getState(), TaskState::Fatal), as_string(reader.getStateName()),
          reader.getUpdates()};
}

void encode(const task_host::TaskDetails& details, wire::Details::Builder builder) {
  encode_histogram(details.timing.updates, builder.initUpdates());
  encode_histogram(details.timing.latencies, builder.initLatencies());
  encode_list(details.log, builder.initLog(count_of(details.log)), encode_line);
}

task_host::TaskDetails decode(wire::Details::Reader reader) {
  return {{decode_histogram(reader.getUpdates()), decode_histogram(reader.getLatencies())},
          decode_list<LogLine>(reader.getLog(), decode_line)};
}

void encode(const sample_link::Latency& latency, wire::Latency::Builder builder) {
  builder.setMeasured(latency.measured);
  builder.setMean(latency.mean.count());
  builder.setWorst(latency.worst.count());
  builder.setP99(latency.p99.count());
}

sample_link::Latency decode(wire::Latency::Reader reader) {
  return {reader.getMeasured(), Duration(reader.getMean()), Duration(reader.getWorst()),
          Duration(reader.getP99())};
}

void encode(const task_host::ConnectionReport& report, wire::ConnectionReport::Builder builder) {
  encode(report.connection, builder.initConnection());
  builder.setWritten(report.written);
  builder.setRead(report.read);
  builder.setDropped(report.dropped);
  encode(report.latency, builder.initLatency());
  builder.setError(as_text(report.error));
}

task_host::ConnectionReport decode(wire::ConnectionReport::Reader reader) {
  return {decode(reader.getConnection()), reader.getWritten(),         reader.getRead(), reader.getDropped(),
          decode(reader.getLatency()),    as_string(reader.getError())};
}

void encode(const task::SavedState& state, wire::State::Builder builder) {
  builder.setName(as_text(state.name));
  builder.setVersion(state.version);
  put(state.value, builder.initValue());
}

task::SavedState decode(wire::State::Reader reader) {
  return {as_string(reader.getName()), reader.getVersion(), get(reader.getValue())};
}

void encode(const task_host::TaskEvent& event, wire::TaskEvent::Builder builder) {
  builder.setTask(as_text(event.task.str()));
  builder.setState(static_cast<std::uint8_t>(event.state));
  builder.setMessage(as_text(event.message));
}

task_host::TaskEvent decode(wire::TaskEvent::Reader reader) {
  return {TaskId(as_string(reader.getTask())), enum_from(reader.getState(), TaskState::Fatal),
          as_string(reader.getMessage())};
}

void encode(const task_host::Completed& ended, wire::Ended::Builder builder) {
  builder.setIndex(static_cast<std::uint32_t>(ended.index));
  encode(ended.outcome, builder.initOutcome());
  builder.setTook(ended.took ? ended.took->count() : -1);
  builder.setBegin(ended.span ? ended.span->begin.count() : -1);
  builder.setEnd(ended.span ? ended.span->end.count() : -1);
  builder.setBegun(ended.begun);
}

task_host::Completed decode(wire::Ended::Reader reader) {
  task_host::Completed ended{reader.getIndex(), decode(reader.getOutcome())};
  if (reader.getTook() >= 0) ended.took = Duration(reader.getTook());
  if (reader.getBegin() >= 0 && reader.getEnd() >= 0)
    ended.span = task_host::Span{Duration(reader.getBegin()), Duration(reader.getEnd())};
  ended.begun = reader.getBegun();
  return ended;
}

}  // namespace segue::control::detail
