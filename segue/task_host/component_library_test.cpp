// SPDX-License-Identifier: Apache-2.0
#include <segue/task_host/component_library.hpp>

#include <segue/base/file.hpp>
#include <segue/model/files.hpp>
#include <segue/model/validate.hpp>
#include <segue/task_host/test_support.hpp>

#include <support/paths.hpp>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdlib>

namespace family {

class Arm : public segue::task::Component {
 public:
  Arm() {
    dynamic_outputs<double>("joint_\\w+", "one per joint");
    dynamic_inputs<double>("command_\\w+");
  }
};

class Broken : public segue::task::Component {
 public:
  Broken() { dynamic_inputs<double>("joint_("); }
};

}  // namespace family

SEGUE_COMPONENT(family::Arm)

namespace segue::task_host {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;

/// SEGUE_LIBRARY_PATH leads to an own folder and to the libraries built for tests.
class ComponentLibrary : public ::testing::Test {
 protected:
  ComponentLibrary() {
    fs::create_directories(folder_);
    const std::string path = folder_.string() + "::" + segue::paths::kTestLibraries;
    ::setenv("SEGUE_LIBRARY_PATH", path.c_str(), 1);
  }
  ~ComponentLibrary() override {
    ::unsetenv("SEGUE_LIBRARY_PATH");
    std::error_code ignored;
    fs::remove_all(folder_, ignored);
  }

  fs::path folder_ = fs::temp_directory_path() / ("segue_library_test_" + std::to_string(::getpid()));
  LibrarySet libraries_;
};

TEST_F(ComponentLibrary, APathIsNoName) {
  for (const char* name : {"../demo", "/lib/demo", "a/b", "", "..", ".", "demo\n", "-x"}) {
    const auto found = find_library(name);
    ASSERT_FALSE(found) << name;
    EXPECT_EQ(found.error().code, ErrorCode::InvalidArgument) << name;
    EXPECT_FALSE(libraries_.load(name)) << name;
  }
}

TEST_F(ComponentLibrary, OneThatIsMissingIsNamedWithWhereItWasLookedFor) {
  const auto loaded = libraries_.load("segue_test_fist");
  ASSERT_FALSE(loaded);
  EXPECT_EQ(loaded.error().code, ErrorCode::NotFound);
  EXPECT_THAT(loaded.error().message, HasSubstr(folder_.string()));
  EXPECT_THAT(loaded.error().message, HasSubstr("did you mean 'segue_test_first'"));
}

TEST_F(ComponentLibrary, ATextFileIsRefusedInTheWordsOfTheLoader) {
  ASSERT_TRUE(write_file(folder_ / "libtext.so", "not a library at all"));
  const auto loaded = libraries_.load("text");
  ASSERT_FALSE(loaded);
  EXPECT_EQ(loaded.error().code, ErrorCode::IoError);
  EXPECT_THAT(loaded.error().message, HasSubstr("file too short"));
}

TEST_F(ComponentLibrary, ALibraryWithoutComponentsIsRefused) {
  fs::create_symlink(segue::paths::kEmptyLibrary, folder_ / "libempty.so");
  const auto loaded = libraries_.load("empty");
  ASSERT_FALSE(loaded);
  EXPECT_THAT(loaded.error().message, HasSubstr("offers no components"));
}

TEST_F(ComponentLibrary, OneBuiltAgainstAnotherSegueIsRefused) {
  const auto loaded = libraries_.load("segue_test_old_abi");
  ASSERT_FALSE(loaded);
  EXPECT_EQ(loaded.error().code, ErrorCode::Unsupported);
  EXPECT_THAT(loaded.error().message, HasSubstr("segue-0.0/0"));
  EXPECT_FALSE(libraries_.has(model::ComponentName("old::Component")));
}

TEST_F(ComponentLibrary, TwoThatOfferTheSameComponentCannotBothBeLoaded) {
  ASSERT_TRUE(libraries_.load("segue_test_first"));
  ASSERT_TRUE(libraries_.load("segue_test_first")) << "again is free";
  const auto second = libraries_.load("segue_test_second");
  ASSERT_FALSE(second);
  EXPECT_EQ(second.error().code, ErrorCode::AlreadyExists);
  EXPECT_THAT(second.error().message, HasSubstr("segue_test_first"));
  const LibrarySet other;
  EXPECT_FALSE(other.has(model::ComponentName("duplicate::Component"))) << "not loaded by that set";
  EXPECT_TRUE(libraries_.create(model::ComponentName("duplicate::Component")));
}

TEST_F(ComponentLibrary, ItsExportedModelsCanBeReadWithoutIt) {
  ::setenv("SEGUE_LIBRARY_PATH", segue::paths::kComponentFolder, 1);
  model::ComponentCatalog catalog;
  const auto read = read_library_models("segue_components_demo", catalog);
  ASSERT_TRUE(read) << to_string(read.error());
  const auto* drive = catalog.find(model::ComponentName("demo::Drive"));
  ASSERT_NE(drive, nullptr);
  EXPECT_NE(drive->find_port("command", model::Direction::Input), nullptr);
  EXPECT_TRUE(drive->find_property("max_speed")->live);
  EXPECT_NE(catalog.types().find("/demo/Velocity"), nullptr);

  ASSERT_TRUE(libraries_.load("segue_components_demo"));
  type::TypeRegistry types;
  const auto models = libraries_.export_models("segue_components_demo", types);
  ASSERT_TRUE(models);
  EXPECT_EQ(models->size(), 8U);
}

TEST_F(ComponentLibrary, DeclaredFamiliesOfDynamicPortsAreExportedAndChecked) {
  const auto text = write_library_models(libraries_, "");
  ASSERT_TRUE(text) << to_string(text.error());
  model::ComponentCatalog catalog;
  Diagnostics diagnostics;
  ASSERT_TRUE(model::read_components(*text, "models.yaml", catalog, diagnostics)) << to_string(diagnostics);
  const auto* arm = catalog.find(model::ComponentName("family::Arm"));
  ASSERT_NE(arm, nullptr);
  const auto* port = arm->find_port("joint_wrist", model::Direction::Output);
  ASSERT_NE(port, nullptr);
  EXPECT_TRUE(port->pattern);
  EXPECT_TRUE(port->dynamic);
  EXPECT_EQ(port->type, "/double");
  EXPECT_EQ(port->doc, "one per joint");

  const auto validated = [&](std::string_view output) {
    model::Network network;
    network.name = model::NetworkName("net");
    network.tasks = {testing::task_of("arm", "family::Arm"), testing::task_of("other", "family::Arm")};
    for (auto& task : network.tasks)
      task.state = TaskState::Running;
    network.connections = {testing::wire("arm", output, "other", "command_wrist")};
    return model::validate(network, catalog, model::Depth::Full);
  };
  EXPECT_FALSE(validated("joint_wrist").has_errors()) << to_string(validated("joint_wrist"));
  EXPECT_TRUE(validated("joint").has_errors()) << "the whole name must match";
}

TEST_F(ComponentLibrary, AFamilyThatIsNoExpressionIsRefusedAtExport) {
  ASSERT_TRUE(libraries_.load("segue_test_first"));
  const auto make = +[]() -> std::unique_ptr<task::Component> { return std::make_unique<family::Broken>(); };
  ASSERT_TRUE(task::register_component(
      {"family::Broken", "segue_test_first", std::string(task::kComponentAbi), make}));
  type::TypeRegistry types;
  const auto models = libraries_.export_models("segue_test_first", types);
  ASSERT_FALSE(models);
  EXPECT_THAT(to_string(models.error()), HasSubstr("joint_("));
}

TEST_F(ComponentLibrary, AComponentThatNobodyOffersTellsWhatToDo) {
  const auto made = libraries_.create(model::ComponentName("unknown::Task"));
  ASSERT_FALSE(made);
  EXPECT_THAT(made.error().message, HasSubstr("'libraries' of the robot file"));
}

}  // namespace
}  // namespace segue::task_host
