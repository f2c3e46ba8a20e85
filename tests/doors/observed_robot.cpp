// SPDX-License-Identifier: Apache-2.0
#include <doors/observed_robot.hpp>

#include <segue/base/file.hpp>
#include <segue/rpc_tls/credential_files.hpp>
#include <segue/task/component.hpp>
#include <segue/type/json.hpp>

#include <gtest/gtest.h>
#include <sys/stat.h>

#include <atomic>
#include <chrono>
#include <cstdlib>
#include <set>
#include <utility>

namespace doors_test {

/// What the task below was given.
std::atomic<int> received{0};  // NOLINT(cppcoreguidelines-avoid-non-const-global-variables)
std::atomic<int> called{0};    // NOLINT(cppcoreguidelines-avoid-non-const-global-variables)

/// Writes numbers, and counts what comes in.
class Witness final : public segue::task::Component {
 public:
  Witness() : Component({.activity = segue::periodic(std::chrono::milliseconds(5))}) {}

 private:
  void on_update() override {
    int sample = 0;
    while (input_.read(sample) == segue::task::ReadStatus::NewData)
      ++received;
    output_.write(++updates_);
  }

  segue::task::InputPort<int> input_{*this, "in"};
  segue::task::OutputPort<int> output_{*this, "out"};
  segue::task::Property<double> speed_{*this, "speed", 1.5, segue::task::PropertyOptions{.live = true}};
  segue::task::Operation<void()> poke_{*this, "poke", {}, [] { ++called; }};
  int updates_ = 0;
};

}  // namespace doors_test

SEGUE_COMPONENT(doors_test::Witness)

namespace segue::doors {

namespace {

namespace fs = std::filesystem;
using control::Credentials;
using type::Value;

constexpr std::string_view kMission =
    "mission: fetch\nactions: {look: {run: {simulated: {duration: 1s}}}}\nstart: look\n"
    "states: {look: {on: {success: return success}}}\n";

void write(const fs::path& file, std::string_view text) {
  const auto written = write_file(file, text);
  ASSERT_TRUE(written) << to_string(written.error());
}

/// What of the answer does not change by itself.
Value lasting(const Value& status) {
  Value::List tasks;
  for (const Value& task : status.find("tasks")->as_list())
    tasks.push_back(Value::list({*task.find("id"), *task.find("component"), *task.find("state")}));
  Value::List connections;
  for (const Value& connection : status.find("connections")->as_list())
    connections.push_back(Value::list({*connection.find("from"), *connection.find("to")}));
  Value all = Value::map({{"tasks", std::move(tasks)}, {"connections", std::move(connections)}});
  for (const char* field :
       {"controller", "version", "loaded_version", "changed_files", "state", "controllers", "requests",
        "pools", "differences", "commanded_by", "doing", "halt", "stopped_by"})
    all.as_map().set(field, *status.find(field));
  return all;
}

}  // namespace

ObservedRobot::ObservedRobot() {
  std::string pattern = ::testing::TempDir() + "segue-doors-XXXXXX";
  EXPECT_NE(::mkdtemp(pattern.data()), nullptr);
  folder_ = pattern;
  home_ = folder_ / "home";
  enrolled_ = folder_ / "enrolled";
  ::setenv("XDG_RUNTIME_DIR", (folder_ / "run").c_str(), 1);
  ::setenv("XDG_STATE_HOME", (folder_ / "state").c_str(), 1);
  make_files();
  open_robot();
  open_doors();
}

ObservedRobot::~ObservedRobot() {
  studio_.reset();
  robot_door_.reset();
  host_door_.reset();
  processes_door_.reset();
  lease_.reset();
  service_.reset();
  robot_.reset();
  host_.reset();
  fs::remove_all(folder_);
}

void ObservedRobot::make_files() const {
  for (const char* name : {"home/networks", "home/missions", "outside", "page", "run", "state"})
    fs::create_directories(folder_ / name);
  fs::permissions(folder_ / "run", fs::perms::owner_all);
  write(home_ / "robot.yaml", "robot: rover\ncontrollers: [networks/*.yaml]\nmissions: [missions/*.yaml]\n");
  write(home_ / "networks" / "watch.yaml",
        "network: watch\ntasks: {witness: {component: doors_test::Witness}}\n");
  write(home_ / "networks" / "rest.yaml", "network: rest\ntasks: {}\n");
  write(home_ / "missions" / "fetch.yaml", kMission);
  write(home_ / "notes.txt", kSecret);
  const std::string secret(kSecret);
  write(folder_ / "outside" / "secret.yaml", "mission: " + secret + "\n" + secret + ": [" + secret + "\n");
  write(folder_ / "outside" / "network.yaml", "network: " + secret + "\ntasks: {}\n");
  write(folder_ / "page" / "index.html", "<title>the page</title>");
  fs::create_symlink(folder_ / "outside" / "secret.yaml", home_ / "link.yaml");
  fs::create_symlink(folder_ / "outside" / "secret.yaml", home_ / "missions" / "link.yaml");
  fs::create_directory_symlink(folder_ / "outside", home_ / "up");
  EXPECT_EQ(::mkfifo((home_ / "pipe.yaml").c_str(), 0600), 0);
  EXPECT_EQ(::mkfifo((home_ / "missions" / "pipe.yaml").c_str(), 0600), 0);
}

void ObservedRobot::open_robot() {
  runtime::EmbeddedOptions options;
  options.journal = true;
  options.journal_file = folder_ / "state" / "journal.sqlite";
  auto robot = runtime::EmbeddedRobot::open(home_ / "robot.yaml", options);
  ASSERT_TRUE(robot) << to_string(robot.error());
  robot_.emplace(std::move(*robot));
  ASSERT_EQ(robot_->switch_to("watch").outcome, runtime::Outcome::Done);
  service_.emplace(robot_->runtime(), &robot_->files(), [this] { asked_to_end_ = true; });
  auto lease = service_->lease("the mission");
  ASSERT_TRUE(lease) << to_string(lease.error());
  lease_ = std::move(*lease);
}

void ObservedRobot::open_doors() {
  auto authority = control::Authority::create(folder_ / "ca").value();
  EXPECT_TRUE(authority.enrol({.name = "left", .host = true, .addresses = {"127.0.0.1"}}, enrolled_));
  EXPECT_TRUE(authority.enrol({.name = "olga", .role = control::Role::Observe}, enrolled_));
  EXPECT_TRUE(authority.enrol({.name = "otto", .role = control::Role::Operate}, enrolled_));
  host_.emplace("left");
  const auto open = [&](control::Served served, const fs::path& socket) {
    auto server = control::Server::listen(control::Places{socket, place()}, served);
    EXPECT_TRUE(server) << to_string(server.error());
    return std::move(*server);
  };
  const fs::path socket = control::socket_path("rover").value();
  robot_door_ = open(&*service_, socket);
  host_door_ = open(host_->local.get(), {});
  processes_door_ = open(&processes_, {});
  web::ServerOptions options{.robot = "rover", .periods = {.snapshots = std::chrono::milliseconds(20)}};
  options.credentials = load_credentials(enrolled_, control::CertificateUse::Host, "left").value();
  const auto connect = [socket] { return control::connect(socket, std::chrono::seconds(20)); };
  auto studio =
      web::Server::start(web::PageFiles::read(folder_ / "page").value(), connect, std::move(options));
  ASSERT_TRUE(studio) << to_string(studio.error());
  studio_ = std::move(*studio);
}

control::TcpPlace ObservedRobot::place() const {
  return {{"127.0.0.1", 0}, load_credentials(enrolled_, control::CertificateUse::Host, "left").value()};
}

control::TcpEndpoint ObservedRobot::endpoint(std::string_view kind, const std::string& person) const {
  const auto& door = kind == "robot" ? robot_door_ : kind == "host" ? host_door_ : processes_door_;
  return {{"127.0.0.1", door->port()},
          "left",
          load_credentials(enrolled_, control::CertificateUse::Person, person).value()};
}

std::vector<std::string> ObservedRobot::known_names() const {
  std::vector<std::string> names = {"rover",
                                    "watch",
                                    "rest",
                                    "witness",
                                    "in",
                                    "out",
                                    "speed",
                                    "poke",
                                    "the mission",
                                    "fetch",
                                    "look",
                                    "left",
                                    "robot.yaml",
                                    "doors_test::Witness",
                                    "missions/fetch.yaml",
                                    "networks/watch.yaml",
                                    "link.yaml",
                                    "missions/link.yaml",
                                    "pipe.yaml",
                                    "notes.txt",
                                    "up/secret.yaml",
                                    "missions/pipe.yaml",
                                    "status",
                                    "events",
                                    "task/witness",
                                    "port/witness/out",
                                    "port/witness/in"};
  for (const fs::path& file : {home_ / "robot.yaml", folder_ / "outside" / "secret.yaml",
                               folder_ / "outside" / "network.yaml", enrolled_ / "left.key"})
    names.push_back(file.string());
  return names;
}

std::string ObservedRobot::files() const {
  std::set<std::string> found;
  for (const fs::path& top : {home_, folder_ / "outside", folder_ / "page", enrolled_}) {
    for (const auto& entry : fs::recursive_directory_iterator(top)) {
      const bool is_file = entry.symlink_status().type() == fs::file_type::regular;
      found.insert(entry.path().string() + " " + (is_file ? read_file(entry.path()).value() : ""));
    }
  }
  std::string all;
  for (const std::string& one : found)
    all += one + "\n";
  return all;
}

std::string ObservedRobot::state() {
  // Whoever looks at a mission may have it say once what it is.
  auto asked = lease_->asked().value();
  std::erase_if(asked, [](const control::HolderRequest& request) { return request.what == "plan"; });
  Value all = Value::map({{"status", lasting(service_->status().value())},
                          {"history", service_->history().value()},
                          {"mission", service_->mission(0, false).value()},
                          {"received", doors_test::received.load()},
                          {"called", doors_test::called.load()},
                          {"asked_to_end", asked_to_end_},
                          {"lost_to", lease_->standing().value().lost_to.value_or("")},
                          {"asked_of_holder", asked.size()},
                          {"hosted_robots", host_->local->robots().value().size()},
                          {"launched", processes_.launched.robot},
                          {"files", files()}});
  all.as_map().set("properties", robot_->host().properties(model::TaskId("witness")).value());
  return type::to_json(all, 1);
}

}  // namespace segue::doors
