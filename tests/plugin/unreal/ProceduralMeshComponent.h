#pragma once

#include "Components/SceneComponent.h"
#include "CoreMinimal.h"

// Unreal's component for meshes made at run time, as far as the plug-in uses it.

struct FProcMeshTangent {};

class UProceduralMeshComponent : public USceneComponent {
 public:
  using Super = UProceduralMeshComponent;  // derived classes call their base by this name
  struct FMesh {
    TArray<FVector> Vertices, Normals;
    TArray<int32> Triangles;
    TArray<FColor> Colors;
  };
  explicit UProceduralMeshComponent(const FObjectInitializer& Initializer) : USceneComponent(Initializer) {}
  void CreateMeshSection(int32 Section, const TArray<FVector>& Vertices, const TArray<int32>& Triangles,
                         const TArray<FVector>& Normals, const TArray<FVector2D>&,
                         const TArray<FColor>& Colors, const TArray<FProcMeshTangent>&, bool) {
    Shown[Section] = {Vertices, Normals, Triangles, Colors};
  }
  void ClearMeshSection(int32 Section) { Shown.erase(Section); }
  void ClearAllMeshSections() { Shown.clear(); }

  std::map<int32, FMesh> Shown;  // the mesh of each section, by its index
};
