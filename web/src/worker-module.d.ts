declare module "worker:decode-worker" {
  const text: string;
  export default text;
}
