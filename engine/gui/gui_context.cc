#include "engine/gui/gui_context.h"

#include <imgui.h>

#include <algorithm>

#include "engine/assets.h"

namespace planecast::engine {
namespace {

/// Latin, the general punctuation we use, arrows.
constexpr ImWchar kGlyphs[] = {0x20, 0xFF, 0x2010, 0x2026, 0x2190, 0x2193, 0};

void set_style() {
  ImGui::StyleColorsDark();
  ImGuiStyle& style = ImGui::GetStyle();
  style.WindowRounding = 0.0F;
  style.WindowBorderSize = 0.0F;
  style.ChildRounding = style.FrameRounding = style.GrabRounding = style.TabRounding = 4.0F;
  style.WindowPadding = {10.0F, 8.0F};
  style.FramePadding = {8.0F, 4.0F};
  style.ItemSpacing = {8.0F, 6.0F};
  style.CellPadding = {6.0F, 3.0F};
  style.ScrollbarSize = 12.0F;
  const ImVec4 accent(0.26F, 0.56F, 0.90F, 1.0F);
  const ImVec4 quiet(0.20F, 0.23F, 0.26F, 1.0F);
  const auto set = [&style](ImGuiCol color, const ImVec4& value) { style.Colors[color] = value; };
  set(ImGuiCol_WindowBg, {0.095F, 0.105F, 0.12F, 1.0F});
  set(ImGuiCol_ChildBg, {0.065F, 0.073F, 0.083F, 1.0F});
  set(ImGuiCol_FrameBg, quiet);
  set(ImGuiCol_Button, quiet);
  set(ImGuiCol_Tab, quiet);
  set(ImGuiCol_Header, {0.26F, 0.56F, 0.90F, 0.35F});
  set(ImGuiCol_TabActive, {0.18F, 0.38F, 0.62F, 1.0F});
  set(ImGuiCol_CheckMark, accent);
  set(ImGuiCol_SliderGrab, accent);
  set(ImGuiCol_PlotLines, accent);
  set(ImGuiCol_Text, {0.90F, 0.91F, 0.93F, 1.0F});
  set(ImGuiCol_TextDisabled, {0.58F, 0.62F, 0.66F, 1.0F});
}

}  // namespace

GuiContext::GuiContext(float font_px) : context_(nullptr) {
  const std::string font = asset("fonts/Roboto-Regular.ttf").string();
  ImGuiContext* const before = ImGui::GetCurrentContext();
  context_ = ImGui::CreateContext();
  ImGui::SetCurrentContext(context_);
  ImGuiIO& io = ImGui::GetIO();
  io.IniFilename = nullptr;
  io.LogFilename = nullptr;
  io.BackendFlags |= ImGuiBackendFlags_RendererHasVtxOffset;
  io.Fonts->AddFontFromFileTTF(font.c_str(), font_px, nullptr, kGlyphs);
  unsigned char* pixels = nullptr;
  int width = 0;
  int height = 0;
  io.Fonts->GetTexDataAsRGBA32(&pixels, &width, &height);
  // Drawing the font's picture forgets its number.
  io.Fonts->SetTexID(reinterpret_cast<ImTextureID>(kFontTexture));
  set_style();
  if (before != nullptr) ImGui::SetCurrentContext(before);
}

GuiContext::~GuiContext() { ImGui::DestroyContext(context_); }

void GuiContext::make_current() const { ImGui::SetCurrentContext(context_); }

void GuiContext::begin(int width, int height, float step_s) const {
  make_current();
  ImGuiIO& io = ImGui::GetIO();
  io.DisplaySize = {static_cast<float>(width), static_cast<float>(height)};
  io.DeltaTime = std::max(step_s, 1e-4F);
  ImGui::NewFrame();
}

const ImDrawData& GuiContext::end() const {
  make_current();
  ImGui::Render();
  return *ImGui::GetDrawData();
}

render::ImageU8 GuiContext::font_image() const {
  make_current();
  unsigned char* pixels = nullptr;
  int width = 0;
  int height = 0;
  ImGui::GetIO().Fonts->GetTexDataAsRGBA32(&pixels, &width, &height);
  render::ImageU8 image(width, height, 4);
  std::copy_n(pixels, image.pixels.size(), image.pixels.begin());
  return image;
}

}  // namespace planecast::engine
