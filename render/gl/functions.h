#pragma once

#include <GL/glcorearb.h>

namespace planecast::render {

class GlContext;

/// The OpenGL functions this renderer calls: type, name. Everything is direct state access
/// (GL 4.5).
#define PLANECAST_GL_FUNCTIONS(X)                                                      \
  X(PFNGLATTACHSHADERPROC, AttachShader)                                               \
  X(PFNGLBINDFRAMEBUFFERPROC, BindFramebuffer)                                         \
  X(PFNGLBINDSAMPLERPROC, BindSampler)                                                 \
  X(PFNGLBINDTEXTUREUNITPROC, BindTextureUnit)                                         \
  X(PFNGLBINDVERTEXARRAYPROC, BindVertexArray)                                         \
  X(PFNGLBLENDEQUATIONPROC, BlendEquation)                                             \
  X(PFNGLBLENDFUNCPROC, BlendFunc)                                                     \
  X(PFNGLBLITNAMEDFRAMEBUFFERPROC, BlitNamedFramebuffer)                               \
  X(PFNGLCHECKNAMEDFRAMEBUFFERSTATUSPROC, CheckNamedFramebufferStatus)                 \
  X(PFNGLCLEARNAMEDFRAMEBUFFERFIPROC, ClearNamedFramebufferfi)                         \
  X(PFNGLCLEARNAMEDFRAMEBUFFERFVPROC, ClearNamedFramebufferfv)                         \
  X(PFNGLCLEARNAMEDFRAMEBUFFERUIVPROC, ClearNamedFramebufferuiv)                       \
  X(PFNGLCLIPCONTROLPROC, ClipControl)                                                 \
  X(PFNGLCOLORMASKPROC, ColorMask)                                                     \
  X(PFNGLCOMPILESHADERPROC, CompileShader)                                             \
  X(PFNGLCREATEBUFFERSPROC, CreateBuffers)                                             \
  X(PFNGLCREATEFRAMEBUFFERSPROC, CreateFramebuffers)                                   \
  X(PFNGLCREATEPROGRAMPROC, CreateProgram)                                             \
  X(PFNGLCREATERENDERBUFFERSPROC, CreateRenderbuffers)                                 \
  X(PFNGLCREATESAMPLERSPROC, CreateSamplers)                                           \
  X(PFNGLCREATESHADERPROC, CreateShader)                                               \
  X(PFNGLCREATETEXTURESPROC, CreateTextures)                                           \
  X(PFNGLCREATEVERTEXARRAYSPROC, CreateVertexArrays)                                   \
  X(PFNGLCULLFACEPROC, CullFace)                                                       \
  X(PFNGLDELETEBUFFERSPROC, DeleteBuffers)                                             \
  X(PFNGLDELETEFRAMEBUFFERSPROC, DeleteFramebuffers)                                   \
  X(PFNGLDELETEPROGRAMPROC, DeleteProgram)                                             \
  X(PFNGLDELETERENDERBUFFERSPROC, DeleteRenderbuffers)                                 \
  X(PFNGLDELETESAMPLERSPROC, DeleteSamplers)                                           \
  X(PFNGLDELETESHADERPROC, DeleteShader)                                               \
  X(PFNGLDELETETEXTURESPROC, DeleteTextures)                                           \
  X(PFNGLDELETEVERTEXARRAYSPROC, DeleteVertexArrays)                                   \
  X(PFNGLDEPTHFUNCPROC, DepthFunc)                                                     \
  X(PFNGLDEPTHMASKPROC, DepthMask)                                                     \
  X(PFNGLDISABLEPROC, Disable)                                                         \
  X(PFNGLDRAWARRAYSPROC, DrawArrays)                                                   \
  X(PFNGLDRAWELEMENTSPROC, DrawElements)                                               \
  X(PFNGLDRAWELEMENTSBASEVERTEXPROC, DrawElementsBaseVertex)                           \
  X(PFNGLENABLEPROC, Enable)                                                           \
  X(PFNGLENABLEVERTEXARRAYATTRIBPROC, EnableVertexArrayAttrib)                         \
  X(PFNGLFINISHPROC, Finish)                                                           \
  X(PFNGLFRONTFACEPROC, FrontFace)                                                     \
  X(PFNGLGENERATETEXTUREMIPMAPPROC, GenerateTextureMipmap)                             \
  X(PFNGLGETERRORPROC, GetError)                                                       \
  X(PFNGLGETINTEGERVPROC, GetIntegerv)                                                 \
  X(PFNGLGETPROGRAMINFOLOGPROC, GetProgramInfoLog)                                     \
  X(PFNGLGETPROGRAMIVPROC, GetProgramiv)                                               \
  X(PFNGLGETSHADERINFOLOGPROC, GetShaderInfoLog)                                       \
  X(PFNGLGETSHADERIVPROC, GetShaderiv)                                                 \
  X(PFNGLGETSTRINGPROC, GetString)                                                     \
  X(PFNGLGETTEXTUREIMAGEPROC, GetTextureImage)                                         \
  X(PFNGLGETUNIFORMLOCATIONPROC, GetUniformLocation)                                   \
  X(PFNGLLINKPROGRAMPROC, LinkProgram)                                                 \
  X(PFNGLNAMEDBUFFERDATAPROC, NamedBufferData)                                         \
  X(PFNGLNAMEDFRAMEBUFFERDRAWBUFFERSPROC, NamedFramebufferDrawBuffers)                 \
  X(PFNGLNAMEDFRAMEBUFFERREADBUFFERPROC, NamedFramebufferReadBuffer)                   \
  X(PFNGLNAMEDFRAMEBUFFERRENDERBUFFERPROC, NamedFramebufferRenderbuffer)               \
  X(PFNGLNAMEDFRAMEBUFFERTEXTUREPROC, NamedFramebufferTexture)                         \
  X(PFNGLNAMEDRENDERBUFFERSTORAGEMULTISAMPLEPROC, NamedRenderbufferStorageMultisample) \
  X(PFNGLPIXELSTOREIPROC, PixelStorei)                                                 \
  X(PFNGLPOLYGONOFFSETPROC, PolygonOffset)                                             \
  X(PFNGLPROGRAMUNIFORM1FPROC, ProgramUniform1f)                                       \
  X(PFNGLPROGRAMUNIFORM1IPROC, ProgramUniform1i)                                       \
  X(PFNGLPROGRAMUNIFORM2FPROC, ProgramUniform2f)                                       \
  X(PFNGLPROGRAMUNIFORM3FVPROC, ProgramUniform3fv)                                     \
  X(PFNGLPROGRAMUNIFORM4FVPROC, ProgramUniform4fv)                                     \
  X(PFNGLPROGRAMUNIFORMMATRIX3FVPROC, ProgramUniformMatrix3fv)                         \
  X(PFNGLPROGRAMUNIFORMMATRIX4FVPROC, ProgramUniformMatrix4fv)                         \
  X(PFNGLREADPIXELSPROC, ReadPixels)                                                   \
  X(PFNGLSAMPLERPARAMETERFVPROC, SamplerParameterfv)                                   \
  X(PFNGLSAMPLERPARAMETERIPROC, SamplerParameteri)                                     \
  X(PFNGLSCISSORPROC, Scissor)                                                         \
  X(PFNGLSHADERSOURCEPROC, ShaderSource)                                               \
  X(PFNGLSTENCILFUNCPROC, StencilFunc)                                                 \
  X(PFNGLSTENCILOPPROC, StencilOp)                                                     \
  X(PFNGLTEXTUREPARAMETERIPROC, TextureParameteri)                                     \
  X(PFNGLTEXTURESTORAGE2DPROC, TextureStorage2D)                                       \
  X(PFNGLTEXTURESUBIMAGE2DPROC, TextureSubImage2D)                                     \
  X(PFNGLTEXTURESUBIMAGE3DPROC, TextureSubImage3D)                                     \
  X(PFNGLUSEPROGRAMPROC, UseProgram)                                                   \
  X(PFNGLVERTEXARRAYATTRIBBINDINGPROC, VertexArrayAttribBinding)                       \
  X(PFNGLVERTEXARRAYATTRIBFORMATPROC, VertexArrayAttribFormat)                         \
  X(PFNGLVERTEXARRAYELEMENTBUFFERPROC, VertexArrayElementBuffer)                       \
  X(PFNGLVERTEXARRAYVERTEXBUFFERPROC, VertexArrayVertexBuffer)                         \
  X(PFNGLVIEWPORTPROC, Viewport)

/// The functions of one context. A table of our own, because the loaders of the distribution do not
/// work with contexts that have no window system.
struct Gl {
#define PLANECAST_GL_MEMBER(type, name) type name = nullptr;
  PLANECAST_GL_FUNCTIONS(PLANECAST_GL_MEMBER)
#undef PLANECAST_GL_MEMBER
};

/// Fills the table from a current context. Throws std::runtime_error below OpenGL 4.5.
Gl load_functions(const GlContext& context);

}  // namespace planecast::render
