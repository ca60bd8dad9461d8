#include "OsteonReamCup.h"

#include <cmath>

AOsteonReamCup::AOsteonReamCup() {
  PrimaryActorTick.bCanEverTick = true;
  Bone = CreateDefaultSubobject<UOsteonBoneComponent>(TEXT("Bone"));
  RootComponent = Bone;
  Tool = CreateDefaultSubobject<USceneComponent>(TEXT("Tool"));
  Tool->SetupAttachment(Bone);
  Bone->Tool = Tool;
}

void AOsteonReamCup::Tick(float DeltaTime) {
  Super::Tick(DeltaTime);
  if (!Bone->IsOpen()) return;
  constexpr double kStart_cm = -1.6;  // height of the apex over the site's centre at which the feed begins
  // time from the start to the turning point, and again from there to the start
  constexpr double kTurn_s = 5.0;
  const double Before_s = std::fmod(Seconds, 2.0 * kTurn_s);
  Seconds += DeltaTime;
  const double Now_s = std::fmod(Seconds, 2.0 * kTurn_s);
  const double Fed_s = Now_s < kTurn_s ? Now_s : 2.0 * kTurn_s - Now_s;
  const FTransform Pose = Bone->Approach(kStart_cm - 0.1 * Feed_mm_per_s * Fed_s);
  Tool->SetRelativeTransform(Pose);
  // the coupling's damping needs the velocity; +z points out of the cup
  const FVector Velocity(0.0, 0.0, (Now_s < kTurn_s ? -0.1 : 0.1) * Feed_mm_per_s);
  FVector Force_N, Torque_Nm;
  if (Bone->GetWrench(Pose, Velocity, FVector(0.0, 0.0, 0.0), Force_N, Torque_Nm) &&
      Force_N.Z > LargestForce_N)
    LargestForce_N = Force_N.Z;
  if (Before_s < kTurn_s && Now_s >= kTurn_s)  // at the turning point
    UE_LOG(LogTemp, Log, TEXT("Osteon: up to %.1f N, %.1f mm3 removed"), LargestForce_N,
           Bone->GetRemovedVolume_mm3());
}
