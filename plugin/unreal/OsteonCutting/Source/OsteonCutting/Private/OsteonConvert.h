#pragma once

#include "CoreMinimal.h"
#include "osteon_host.h"

// Conversions between Unreal's types and those of osteon_host.h, both in Unreal's axes and centimetres.

namespace OsteonConvert {

// Osteon orders a quaternion (w, x, y, z), Unreal (x, y, z, w).
inline osteon::host::Pose ToPose(const FTransform& Transform) {
  const FVector P = Transform.GetLocation();
  const FQuat Q = Transform.GetRotation();
  return {{P.X, P.Y, P.Z}, {Q.W, Q.X, Q.Y, Q.Z}};
}

inline osteon::host::Twist ToTwist(const FVector& Linear, const FVector& Angular) {
  return {{Linear.X, Linear.Y, Linear.Z}, {Angular.X, Angular.Y, Angular.Z}};
}

inline osteon::host::Wrench ToWrench(const FVector& Force, const FVector& Torque) {
  return {{Force.X, Force.Y, Force.Z}, {Torque.X, Torque.Y, Torque.Z}};
}

inline FVector ToVector(const osteon::host::Vector& V) { return FVector(V[0], V[1], V[2]); }

inline FTransform ToTransform(const osteon::host::Pose& Pose) {
  const osteon::host::Quaternion& Q = Pose.orientation;
  return FTransform(FQuat(Q[1], Q[2], Q[3], Q[0]), ToVector(Pose.position));
}

/// The arrays of a section of UProceduralMeshComponent.
struct FSection {
  TArray<FVector> Vertices, Normals;
  TArray<int32> Triangles;
  TArray<FColor> Colors;
};

/// The mesh of one brick; every colour is opaque.
inline FSection ToSection(const osteon::host::Brick& Brick) {
  FSection Section;
  const int32 Count = static_cast<int32>(Brick.positions.size() / 3);
  Section.Vertices.Reserve(Count);
  Section.Normals.Reserve(Count);
  Section.Colors.Reserve(Count);
  for (int32 Vertex = 0; Vertex < Count; ++Vertex) {
    const float* P = &Brick.positions[3 * Vertex];
    const float* N = &Brick.normals[3 * Vertex];
    const uint8* C = &Brick.colors[3 * Vertex];
    Section.Vertices.Add(FVector(P[0], P[1], P[2]));
    Section.Normals.Add(FVector(N[0], N[1], N[2]));
    Section.Colors.Add(FColor(C[0], C[1], C[2], 255));
  }
  Section.Triangles.Reserve(static_cast<int32>(Brick.indices.size()));
  for (const int32 Index : Brick.indices) Section.Triangles.Add(Index);
  return Section;
}

}  // namespace OsteonConvert
