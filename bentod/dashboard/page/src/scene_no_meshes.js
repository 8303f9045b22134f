/** Stands in for three's mesh loaders, which scene_robot.js never asks: the page stays small. */

export class ColladaLoader {}
export class STLLoader {}
