#include "rilievo/scene/assimp_read.h"

#include <assimp/config.h>
#include <assimp/material.h>
#include <assimp/mesh.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>

#include <algorithm>
#include <assimp/Importer.hpp>
#include <charconv>
#include <cmath>
#include <map>

#include "rilievo/scene/assimp_files.h"
#include "rilievo/scene/assimp_material.h"
#include "rilievo/scene/mesh_tools.h"

namespace rilievo {
namespace {

// Its header says how many elements of each kind follow; each has at least one byte.
void check_ply_header(Bytes file) {
  const std::string_view text(reinterpret_cast<const char*>(file.data()), file.size());
  const std::size_t end = text.find("end_header");
  if (end == std::string_view::npos) refuse("is a PLY file whose header has no end");
  std::size_t at = 0;
  while ((at = text.find("\nelement ", at)) < end) {
    at += 9;
    const std::size_t line_end = text.find_first_of("\r\n", at);
    const std::string_view line = text.substr(at, line_end - at);
    const std::string_view digits = line.substr(line.find_last_of(' ') + 1);
    std::uint64_t count = 0;
    const auto parsed = std::from_chars(digits.data(), digits.data() + digits.size(), count);
    if (parsed.ec != std::errc() || count > file.size())
      refuse("is a PLY file that announces more elements than it can hold");
  }
}

void check_text(const std::string& text, const char* kind) {
  // A zero is in no text, but soon in anything else.
  if (text.substr(0, 4096).find('\0') != std::string::npos)
    refuse(std::string("is not ") + kind + ": it holds binary data");
}

glm::vec3 vec3(const aiVector3D& v) { return {v.x, v.y, v.z}; }

glm::mat4 mat4(const aiMatrix4x4& m) {
  return glm::transpose(glm::mat4(m.a1, m.a2, m.a3, m.a4, m.b1, m.b2, m.b3, m.b4, m.c1, m.c2, m.c3,
                                  m.c4, m.d1, m.d2, m.d3, m.d4));
}

Mesh read_mesh(const aiMesh& from, bool flat, LoadContext& context) {
  Mesh mesh;
  mesh.name = from.mName.C_Str();
  const std::size_t n = from.mNumVertices;
  context.budget.take(n, 12 + (from.HasNormals() ? 12 : 0) + (from.HasTextureCoords(0) ? 8 : 0) +
                             (from.HasVertexColors(0) ? 16 : 0));
  context.budget.take(from.mNumFaces, 12);
  for (std::size_t i = 0; i < n; ++i) {
    mesh.positions.push_back(vec3(from.mVertices[i]));
    if (!std::isfinite(glm::dot(glm::dvec3(mesh.positions[i]), glm::dvec3(1))))
      refuse("has a vertex whose position is not finite");
    if (from.HasNormals() && !flat) mesh.normals.push_back(vec3(from.mNormals[i]));
    if (from.HasTextureCoords(0))
      mesh.uv[0].push_back({from.mTextureCoords[0][i].x, from.mTextureCoords[0][i].y});
    if (from.HasVertexColors(0)) {
      // Scanners and sculpting programs write what a screen shows.
      const aiColor4D& c = from.mColors[0][i];
      mesh.colors.push_back(
          {linear_from_srgb(c.r), linear_from_srgb(c.g), linear_from_srgb(c.b), c.a});
    }
  }
  for (std::size_t f = 0; f < from.mNumFaces; ++f) {
    const aiFace& face = from.mFaces[f];
    if (face.mNumIndices != 3) continue;
    for (int k = 0; k < 3; ++k) {
      if (face.mIndices[k] >= n) refuse("has a face that refers to a vertex that does not exist");
      mesh.indices.push_back(face.mIndices[k]);
    }
  }
  if (repair_attributes(mesh) > 0) context.warn("attributes that are not finite are replaced");
  if (mesh.normals.empty())
    make_flat(mesh);
  else
    repair_normals(mesh);
  return mesh;
}

class Reader {
 public:
  Reader(const aiScene& from, bool flat, LoadContext& context)
      : from_(from), flat_(flat), context_(context), materials_(from, context, scene_) {}

  Scene read() {
    scene_.name = context_.name;
    // Depth first, without recursion: a file may nest as deep as it likes.
    std::vector<std::pair<const aiNode*, glm::mat4>> open{{from_.mRootNode, glm::mat4(1.0f)}};
    while (!open.empty()) {
      const auto [node, world_from_parent] = open.back();
      open.pop_back();
      const glm::mat4 world_from_node = world_from_parent * mat4(node->mTransformation);
      add_object(*node, world_from_node);
      for (unsigned i = node->mNumChildren; i-- > 0;)
        open.emplace_back(node->mChildren[i], world_from_node);
    }
    return std::move(scene_);
  }

 private:
  void add_object(const aiNode& node, const glm::mat4& world_from_node) {
    Model model;
    model.name = node.mName.C_Str();
    for (unsigned i = 0; i < node.mNumMeshes; ++i)
      if (const int mesh = mesh_of(node.mMeshes[i]); mesh >= 0) model.parts.push_back({mesh});
    if (model.parts.empty()) return;
    context_.budget.take(2 * (sizeof(Object) + sizeof(Model)) + 2 * model.name.size());
    Object object;
    object.name = model.name;
    object.model = int(scene_.models.size());
    object.placement = world_from_node;
    scene_.models.push_back(std::move(model));
    scene_.objects.push_back(std::move(object));
  }

  int mesh_of(unsigned i) {
    const auto [known, fresh] = meshes_.try_emplace(i, -1);
    if (!fresh) return known->second;
    const aiMesh& from = *from_.mMeshes[i];
    if (!(from.mPrimitiveTypes & aiPrimitiveType_TRIANGLE)) {
      context_.skip_points_or_lines();
      return -1;
    }
    Mesh mesh = read_mesh(from, flat_, context_);
    if (mesh.indices.empty()) return -1;
    mesh.material = materials_.use(from.mMaterialIndex, !mesh.colors.empty());
    known->second = int(scene_.meshes.size());
    scene_.meshes.push_back(std::move(mesh));
    return known->second;
  }

  const aiScene& from_;
  bool flat_;
  LoadContext& context_;
  Scene scene_;
  AssimpMaterials materials_;
  std::map<unsigned, int> meshes_;
};

}  // namespace

Scene read_with_assimp(Bytes file, const std::string& extension, LoadContext& context) {
  if (extension == "ply") check_ply_header(file);
  // assimp keeps each corner of each face several times over before vertices are joined.
  context.budget.borrow(file.size(), 32);
  std::string text = extension == "obj"
                         ? utf8_from(file)
                         : std::string(reinterpret_cast<const char*>(file.data()), file.size());
  if (extension == "obj") check_text(text, "an OBJ file");

  // assimp looks for "NAME.mtl", too, if the file names a library that is not there.
  const std::string name = context.name + "." + extension;
  Assimp::Importer importer;
  importer.SetIOHandler(new AssimpFiles(name, std::move(text), context));  // which owns it
  // Without normals: smooth, but for edges sharper than this.
  importer.SetPropertyFloat(AI_CONFIG_PP_GSN_MAX_SMOOTHING_ANGLE, 45.0f);
  const bool flat = extension == "stl";
  const unsigned steps = aiProcess_Triangulate | aiProcess_SortByPType | aiProcess_FlipUVs |
                         aiProcess_JoinIdenticalVertices |
                         (flat ? 0u : unsigned(aiProcess_GenSmoothNormals));
  const aiScene* const scene = importer.ReadFile(name, steps);
  if (!scene || !scene->mRootNode) {
    const std::string why = importer.GetErrorString();
    refuse("cannot be read: " + (why.empty() ? "it holds nothing" : why.substr(0, 200)));
  }
  return Reader(*scene, flat, context).read();
}

}  // namespace rilievo
