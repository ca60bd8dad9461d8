#pragma once

#include "CoreMinimal.h"

#include "OsteonTypes.generated.h"

// Values that the components exchange with Blueprints. Lengths and positions are in centimetres, in the
// bone's frame, unless a name says otherwise.

DECLARE_DYNAMIC_MULTICAST_DELEGATE_OneParam(FOsteonRefused, const FString&, Text);
DECLARE_DYNAMIC_MULTICAST_DELEGATE_ThreeParams(FOsteonSceneEvent, const FString&, Name, double, Value_mm,
                                               const FVector&, Position);

/// The compliant parts, each with its own switch. A figure of 0 means the library's default: a mount of 12 kg
/// and 10 Hz.
USTRUCT(BlueprintType)
struct FOsteonCompliance {
  GENERATED_BODY()

  /// Whether the tool bends, by the figures in its file.
  UPROPERTY(EditAnywhere, BlueprintReadWrite, Category = "Osteon")
  bool bTool = false;
  /// Whether soft tissue on the surface yields, by the figures of the bone's materials.
  UPROPERTY(EditAnywhere, BlueprintReadWrite, Category = "Osteon")
  bool bLayer = false;
  /// Whether the bone moves on its mount.
  UPROPERTY(EditAnywhere, BlueprintReadWrite, Category = "Osteon")
  bool bMount = false;
  /// Time between two calls of GetWrench, in milliseconds.
  UPROPERTY(EditAnywhere, BlueprintReadWrite, Category = "Osteon")
  double Period_ms = 0.0;
  /// Point about which the mount's stiffness acts.
  UPROPERTY(EditAnywhere, BlueprintReadWrite, Category = "Osteon")
  FVector MountPoint = FVector(0.0, 0.0, 0.0);
  UPROPERTY(EditAnywhere, BlueprintReadWrite, Category = "Osteon")
  double MountMass_kg = 0.0;
  /// Stiffness along the bone's axes.
  UPROPERTY(EditAnywhere, BlueprintReadWrite, Category = "Osteon")
  FVector MountStiffness_N_per_m = FVector(0.0, 0.0, 0.0);
  /// Stiffness about the bone's axes.
  UPROPERTY(EditAnywhere, BlueprintReadWrite, Category = "Osteon")
  FVector MountStiffness_Nm_per_rad = FVector(0.0, 0.0, 0.0);
};

/// Displacement of each compliant part.
USTRUCT(BlueprintType)
struct FOsteonDeflection {
  GENERATED_BODY()

  /// The pose at which to draw the bone.
  UPROPERTY(BlueprintReadOnly, Category = "Osteon")
  FTransform Bone;
  /// Displacement of the tool's head, along the tool's axes.
  UPROPERTY(BlueprintReadOnly, Category = "Osteon")
  FVector Bend = FVector(0.0, 0.0, 0.0);
  /// Displacement of the tissue at the contact.
  UPROPERTY(BlueprintReadOnly, Category = "Osteon")
  FVector Layer = FVector(0.0, 0.0, 0.0);
  /// Displacement of the bone at the mount's point.
  UPROPERTY(BlueprintReadOnly, Category = "Osteon")
  FVector Mount = FVector(0.0, 0.0, 0.0);
  /// Whether compliance is on; if not, all displacements are zero.
  UPROPERTY(BlueprintReadOnly, Category = "Osteon")
  bool bGivesWay = false;
  /// Whether a displacement is beyond its limit: the caller should stop.
  UPROPERTY(BlueprintReadOnly, Category = "Osteon")
  bool bBeyondLimit = false;
};

/// A row of a plan's score.
USTRUCT(BlueprintType)
struct FOsteonScoreItem {
  GENERATED_BODY()

  UPROPERTY(BlueprintReadOnly, Category = "Osteon")
  FString Metric;
  /// Unit of Value: "deg", "mm", "mm3", "ratio".
  UPROPERTY(BlueprintReadOnly, Category = "Osteon")
  FString Unit;
  /// The measured value; NaN: not measured.
  UPROPERTY(BlueprintReadOnly, Category = "Osteon")
  double Value = 0.0;
  /// Largest number of points for this row.
  UPROPERTY(BlueprintReadOnly, Category = "Osteon")
  double Weight = 0.0;
  UPROPERTY(BlueprintReadOnly, Category = "Osteon")
  double Points = 0.0;
};
