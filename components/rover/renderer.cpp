// SPDX-License-Identifier: Apache-2.0
#include "renderer.hpp"

#include <segue/base/mutex.hpp>

#include <GL/osmesa.h>
#include <algorithm>
#include <vector>

namespace rover {
namespace {

struct DestroyContext {
  void operator()(osmesa_context* context) const noexcept { OSMesaDestroyContext(context); }
};
using ContextPtr = std::unique_ptr<osmesa_context, DestroyContext>;

/// Of each pixel, where edges shall be smooth.
constexpr int kSamples = 4;

/// Finding the functions of OpenGL is not safe in several threads.
segue::Mutex context_mutex;

/// The context is the thread's as long as this lives.
class Current {
 public:
  Current(osmesa_context* context, std::vector<std::uint8_t>& window)
      : made_(OSMesaMakeCurrent(context, window.data(), GL_UNSIGNED_BYTE, 16, 16) == GL_TRUE) {}
  Current(const Current&) = delete;
  Current& operator=(const Current&) = delete;
  ~Current() { OSMesaMakeCurrent(nullptr, nullptr, GL_UNSIGNED_BYTE, 0, 0); }
  explicit operator bool() const { return made_; }

 private:
  bool made_;
};

}  // namespace

struct Renderer::Implementation {
  ModelPtr model;
  DataPtr data;
  ContextPtr context;
  std::vector<std::uint8_t> window =
      std::vector<std::uint8_t>(std::size_t{16} * 16 * 4);  ///< nothing is drawn there
  mjvScene scene{};
  mjrContext resources{};
  mjvOption options{};
  mjvCamera camera{};
  mjrRect viewport{};
  std::vector<std::uint8_t> upside_down;  ///< OpenGL begins at the bottom

  ~Implementation() {
    if (context) {
      const Current current(context.get(), window);
      mjr_freeContext(&resources);
    }
    mjv_freeScene(&scene);
  }
  segue::Result<void> open();
};

segue::Result<void> Renderer::Implementation::open() {
  data.reset(mj_makeData(model.get()));
  mjv_defaultOption(&options);
  options.geomgroup[3] = 0;  // shapes for contacts only
  mjv_defaultScene(&scene);
  mjv_makeScene(model.get(), &scene, 200);
  mjr_defaultContext(&resources);
  const segue::Lock lock(context_mutex);
  context.reset(OSMesaCreateContextExt(GL_RGBA, 24, 8, 0, nullptr));
  if (!context) return segue::fail(segue::ErrorCode::Unsupported, "OSMesa gives no context to draw in");
  const Current current(context.get(), window);
  if (!current) return segue::fail(segue::ErrorCode::Unsupported, "OSMesa's context cannot be used");
  mjr_makeContext(model.get(), &resources, mjFONTSCALE_100);
  mjr_setBuffer(mjFB_OFFSCREEN, &resources);
  if (resources.currentBuffer != mjFB_OFFSCREEN) {
    return segue::fail(segue::ErrorCode::Unsupported, "OpenGL has no frame buffers to draw in");
  }
  return {};
}

segue::Result<std::unique_ptr<Renderer>> Renderer::create(const std::string& camera, int width, int height,
                                                          bool smooth) {
  if (width < 1 || height < 1 || width > kLargestPicture || height > kLargestPicture) {
    return segue::fail(segue::ErrorCode::InvalidArgument,
                       "pictures are at most " + std::to_string(kLargestPicture) +
                           " pixels wide and high, not " + std::to_string(width) + " x " +
                           std::to_string(height));
  }
  auto model = load_rover_model();
  if (!model) return std::move(model.error());
  (*model)->vis.global.offwidth = width;
  (*model)->vis.global.offheight = height;
  (*model)->vis.quality.offsamples = smooth ? kSamples : 0;
  auto made = std::make_unique<Implementation>();
  made->model = std::move(*model);
  const int id = mj_name2id(made->model.get(), mjOBJ_CAMERA, camera.c_str());
  if (id < 0) {
    return segue::fail(segue::ErrorCode::NotFound,
                       "the rover has no camera '" + camera + "', only 'mast', 'deck', 'gripper' and 'room'");
  }
  mjv_defaultCamera(&made->camera);
  made->camera.type = mjCAMERA_FIXED;
  made->camera.fixedcamid = id;
  made->viewport = {0, 0, width, height};
  made->upside_down.resize(static_cast<std::size_t>(width) * static_cast<std::size_t>(height) * 3);
  if (auto opened = made->open(); !opened) return std::move(opened.error());
  return std::unique_ptr<Renderer>(new Renderer(std::move(made)));
}

Renderer::Renderer(std::unique_ptr<Implementation> implementation)
    : implementation_(std::move(implementation)) {}
Renderer::~Renderer() = default;

bool Renderer::render(const SceneState& scene, messages::Image& image) {
  Implementation& my = *implementation_;
  if (scene.positions.size() != static_cast<std::size_t>(my.model->nq)) return false;
  std::copy(scene.positions.begin(), scene.positions.end(), my.data->qpos);
  mj_kinematics(my.model.get(), my.data.get());
  mj_camlight(my.model.get(), my.data.get());
  mjv_updateScene(my.model.get(), my.data.get(), &my.options, nullptr, &my.camera, mjCAT_ALL, &my.scene);
  {
    const Current current(my.context.get(), my.window);
    if (!current) return false;
    mjr_render(my.viewport, &my.scene, &my.resources);
    mjr_readPixels(my.upside_down.data(), nullptr, my.viewport, &my.resources);
  }
  image.time = scene.time;
  image.width = static_cast<std::uint32_t>(my.viewport.width);
  image.height = static_cast<std::uint32_t>(my.viewport.height);
  image.rgb.resize(my.upside_down.size());
  const auto row = static_cast<std::ptrdiff_t>(my.viewport.width) * 3;
  for (std::ptrdiff_t y = 0; y < my.viewport.height; ++y) {
    const auto from = my.upside_down.begin() + (my.viewport.height - 1 - y) * row;
    std::copy(from, from + row, image.rgb.begin() + y * row);
  }
  return true;
}

}  // namespace rover
