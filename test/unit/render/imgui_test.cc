#include "render/imgui/painter.h"

#include <gtest/gtest.h>
#include <imgui.h>

#include <array>

namespace planecast::render {
namespace {

constexpr int kSide = 64;
constexpr std::uintptr_t kWhite = 1;
constexpr std::uintptr_t kPicture = 2;

std::string shader_dir() { return std::string(PLANECAST_SOURCE_DIR) + "/assets/shaders"; }

std::array<int, 4> pixel(const ImageU8& image, int x, int y) {
  const std::size_t at = 4 * (static_cast<std::size_t>(y) * kSide + static_cast<std::size_t>(x));
  return {image.pixels[at], image.pixels[at + 1], image.pixels[at + 2], image.pixels[at + 3]};
}

/// ImGui with its own font, and a painter that has it.
class ImGuiPicture : public ::testing::Test {
 protected:
  ImGuiPicture() : painter_(shader_dir()) {
    ImGui::CreateContext();
    ImGuiIO& io = ImGui::GetIO();
    io.IniFilename = nullptr;
    io.DisplaySize = {kSide, kSide};
    io.BackendFlags |= ImGuiBackendFlags_RendererHasVtxOffset;
    unsigned char* pixels = nullptr;
    int width = 0;
    int height = 0;
    io.Fonts->GetTexDataAsRGBA32(&pixels, &width, &height);
    io.Fonts->SetTexID(reinterpret_cast<ImTextureID>(kWhite));
    ImageU8 font(width, height, 4);
    std::copy_n(pixels, font.pixels.size(), font.pixels.begin());
    painter_.set_texture(kWhite, font);
    ImGui::NewFrame();
  }
  ~ImGuiPicture() override { ImGui::DestroyContext(); }

  ImDrawList& list() { return *ImGui::GetBackgroundDrawList(); }
  ImageU8 draw() {
    ImGui::Render();
    return painter_.draw(*ImGui::GetDrawData());
  }

  ImGuiPainter painter_;
};

TEST_F(ImGuiPicture, RectanglesLieWhereTheyWerePutTopRowFirst) {
  list().AddRectFilled({8, 4}, {24, 12}, IM_COL32(200, 100, 50, 255));
  const ImageU8 image = draw();
  EXPECT_EQ(pixel(image, 16, 8), (std::array<int, 4>{200, 100, 50, 255}));
  EXPECT_EQ(pixel(image, 16, kSide - 8), (std::array<int, 4>{0, 0, 0, 0}));
  EXPECT_EQ(pixel(image, 30, 8), (std::array<int, 4>{0, 0, 0, 0}));
}

TEST_F(ImGuiPicture, TranslucentColoursArePremultiplied) {
  list().AddRectFilled({0, 0}, {32, 32}, IM_COL32(200, 100, 50, 128));
  const std::array<int, 4> seen = pixel(draw(), 16, 16);
  EXPECT_NEAR(seen[0], 100, 1);
  EXPECT_NEAR(seen[3], 128, 1);
}

TEST_F(ImGuiPicture, ClipRectanglesCut) {
  list().PushClipRect({0, 0}, {10, 20});
  list().AddRectFilled({0, 0}, {40, 40}, IM_COL32(255, 255, 255, 255));
  list().PopClipRect();
  const ImageU8 image = draw();
  EXPECT_EQ(pixel(image, 5, 19)[3], 255);
  EXPECT_EQ(pixel(image, 5, 20)[3], 0);
  EXPECT_EQ(pixel(image, 10, 5)[3], 0);
}

TEST_F(ImGuiPicture, PicturesAreTheRightWayUp) {
  ImageU8 two(1, 2, 3);
  two.pixels = {255, 0, 0, 0, 0, 255};  // red over blue
  painter_.set_texture(kPicture, two);
  list().AddImage(reinterpret_cast<ImTextureID>(kPicture), {0, 0}, {32, 32});
  const ImageU8 image = draw();
  EXPECT_EQ(pixel(image, 16, 2)[0], 255);
  EXPECT_EQ(pixel(image, 16, 29)[2], 255);
}

TEST_F(ImGuiPicture, ListsOfMoreVerticesThanAnIndexCounts) {
  // 20,000 rectangles have 80,000 vertices; the last one covers another place than the first ones.
  for (int i = 0; i < 20000; ++i) {
    list().AddRectFilled({1, 1}, {3, 3}, IM_COL32(255, 0, 0, 255));
  }
  list().AddRectFilled({40, 40}, {50, 50}, IM_COL32(0, 255, 0, 255));
  const ImageU8 image = draw();
  EXPECT_EQ(pixel(image, 45, 45), (std::array<int, 4>{0, 255, 0, 255}));
  EXPECT_EQ(pixel(image, 2, 2), (std::array<int, 4>{255, 0, 0, 255}));
}

TEST_F(ImGuiPicture, AnUnknownTextureDrawsNothing) {
  list().AddImage(reinterpret_cast<ImTextureID>(std::uintptr_t{99}), {0, 0}, {32, 32});
  EXPECT_EQ(pixel(draw(), 16, 16)[3], 0);
}

}  // namespace
}  // namespace planecast::render
